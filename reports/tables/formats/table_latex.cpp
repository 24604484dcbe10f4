// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include "reports/tables/escaping.h"
#include "reports/tables/formats/table_formats.h"
#include "reports/tables/formats/table_head.h"

namespace stillpoint::report {
namespace {

std::string latex_cell(const TableColumn& column, const TableCell& cell, TableDetail detail,
                       const std::vector<std::string>& notes) {
  std::string text = cell_text(column, cell, detail);
  if (text == "-") text = "--";
  if (cell.is_best) text = "\\textbf{" + text + "}";
  const std::size_t note = footnote_number(notes, cell);
  return note == 0 ? text : text + "$^{\\mathrm{" + note_letter(note) + "}}$";
}

/// The line of group headings and the rules below it.
std::string group_line(const ReportTable& table, std::size_t lead) {
  std::string line(lead - 1, '&');
  std::string rules;
  std::size_t column = lead + 1;
  for (const ColumnGroup& group : column_groups(table)) {
    line += fmt::format(" & \\multicolumn{{{}}}{{c}}{{{}}}", group.columns, escape_latex(group.name));
    if (!group.name.empty())
      rules += fmt::format("\\cmidrule(lr){{{}-{}}}", column, column + group.columns - 1);
    column += group.columns;
  }
  return line + " \\\\\n" + rules + "\n";
}

std::string heading_line(const ReportTable& table) {
  std::string line = escape_latex(table.row_heading);
  if (has_sources(table)) line += " & source";
  for (const TableColumn& column : table.columns) line += " & " + escape_latex(column_heading(column));
  return line + " \\\\\n\\midrule\n";
}

std::string note_lines(const ReportTable& table, const std::vector<std::string>& notes) {
  std::string text;
  for (std::size_t i = 0; i < notes.size(); ++i) {
    text += fmt::format("$^{{\\mathrm{{{}}}}}$ {}\\\\\n", note_letter(i + 1), escape_latex(notes[i]));
  }
  for (const std::string& note : table.notes) text += escape_latex(note) + "\\\\\n";
  return text.empty()
             ? ""
             : "\n\\vspace{1ex}\n\\begin{minipage}{\\linewidth}\\footnotesize\n" + text + "\\end{minipage}\n";
}

}  // namespace

std::string table_latex(const ReportTable& table, TableDetail detail) {
  const std::vector<std::string> notes = footnotes(table);
  const std::size_t lead = has_sources(table) ? 2 : 1;
  std::string text = "\\begin{table*}[t]\n\\centering\n\\caption{" + escape_latex(table.title) + "}\n";
  text += "\\label{table:" + table.name + "}\n";
  text += fmt::format("\\begin{{tabular}}{{{}{}}}\n\\toprule\n", std::string(lead, 'l'),
                      std::string(table.columns.size(), 'r'));
  if (has_groups(table)) text += group_line(table, lead);
  text += heading_line(table);
  std::string label = table.rows.empty() ? "" : table.rows.front().label;
  for (const TableRow& row : table.rows) {
    if (lead == 2 && row.label != label) text += "\\addlinespace\n";
    label = row.label;
    text += escape_latex(row.label);
    if (lead == 2) text += " & " + escape_latex(row.source);
    for (std::size_t i = 0; i < row.cells.size(); ++i) {
      text += " & " + latex_cell(table.columns[i], row.cells[i], detail, notes);
    }
    text += " \\\\\n";
  }
  return text + "\\bottomrule\n\\end{tabular}\n" + note_lines(table, notes) + "\\end{table*}\n";
}

std::string latex_document(const std::string& tables) {
  return "\\documentclass{article}\n\\usepackage[utf8]{inputenc}\n\\usepackage{booktabs}\n"
         "\\usepackage[a3paper,landscape,margin=1cm]{geometry}\n\\begin{document}\n\\scriptsize\n" +
         tables + "\\end{document}\n";
}

}  // namespace stillpoint::report
