// SPDX-License-Identifier: BSD-3-Clause
#include "reports/page/html_parts.h"

#include <fmt/format.h>

#include "bench/config/toml_source.h"
#include "bench/model/metrics.h"
#include "core/base/error.h"
#include "reports/tables/escaping.h"

namespace stillpoint::report {

std::string_view web_file(std::string_view name) {
  constexpr std::string_view kRoot = "reports/web/";
  for (const bench::EmbeddedFile& file : bench::web_files()) {
    if (file.path.substr(kRoot.size()) == name) return file.text;
  }
  STILLPOINT_CHECK(!"every requested file is listed in reports/CMakeLists.txt");
  return {};
}

std::string scripts_html(std::span<const std::string_view> names) {
  std::string text;
  for (const std::string_view name : names) text += fmt::format("<script>\n{}</script>\n", web_file(name));
  return text;
}

std::string filled_template(std::string_view text, const TemplateParts& parts) {
  constexpr std::string_view kOpen = "<!--";
  constexpr std::string_view kClose = "-->";
  std::string result;
  while (true) {
    const std::size_t begin = text.find(kOpen);
    result += text.substr(0, begin);
    if (begin == std::string_view::npos) return result;
    const std::size_t end = text.find(kClose, begin);
    const auto found = parts.find(text.substr(begin + kOpen.size(), end - begin - kOpen.size()));
    if (found != parts.end()) result += found->second;
    text.remove_prefix(end + kClose.size());
  }
}

std::string preformatted(const std::string& text) {
  std::string result;
  std::string_view rest = text;
  while (!rest.empty()) {
    const std::size_t end = rest.find('\n');
    result += escape_html(rest.substr(0, end)) + "\n";
    rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
  }
  return result;
}

std::string html_table(const std::string& id, const std::string& caption,
                       const std::vector<ColumnHead>& heads, const std::string& rows) {
  std::string head;
  for (const ColumnHead& column : heads) {
    head += fmt::format("<th scope=\"col\"{}>{}</th>", column.is_text ? " class=\"text\"" : "", column.text);
  }
  return fmt::format(
      "<div class=\"table\"><table id=\"{}\">{}<thead><tr>{}</tr></thead><tbody>\n{}</tbody></table></div>",
      id, caption.empty() ? "" : "<caption>" + caption + "</caption>", head, rows);
}

std::string metric_heading(const std::string& name) {
  const std::string tooltip = bench::tooltip_of(name);
  return fmt::format("<th scope=\"row\"{}>{}</th>",
                     tooltip.empty() ? "" : fmt::format(" title=\"{}\"", escape_html(tooltip)),
                     escape_html(name));
}

std::string counted(std::size_t count, const std::string& noun) {
  return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

std::string glossary_html(const std::set<std::string>& names) {
  std::string items;
  for (const std::string& name : names) {
    if (const std::string text = bench::tooltip_of(name); !text.empty())
      items += "<dt>" + escape_html(name) + "</dt><dd>" + escape_html(text) + "</dd>\n";
  }
  return items.empty() ? ""
                       : "<details class=\"glossary\"><summary>What the metrics mean</summary><dl>\n" +
                             items + "</dl></details>\n";
}

std::string data_script(const std::string& id, const std::string& json) {
  return fmt::format("<script type=\"application/json\" id=\"{}\">{}</script>\n", id, json_for_script(json));
}

}  // namespace stillpoint::report
