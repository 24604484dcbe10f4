// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/formats/image_lists.h"

#include <algorithm>
#include <cctype>
#include <numeric>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "core/base/counted.h"
#include "eval/io/matrix_files.h"

namespace stillpoint::datasets {
namespace {

/// A text whose bytes compare as the natural order of the name: before each number, its count of digits.
std::string natural_key(const std::string& name) {
  const auto is_digit = [](unsigned char letter) { return std::isdigit(letter) != 0; };
  std::string key;
  for (auto at = name.begin(); at != name.end();) {
    const auto end = std::find_if_not(at, name.end(), is_digit);
    if (end == at) {
      key += *at++;
      continue;
    }
    const auto first = std::find_if(at, end, [](char digit) { return digit != '0'; });
    key += static_cast<char>(end - first);
    key.append(first, end);
    at = end;
  }
  return key;
}

/// The median of the differences in order; 0 for fewer than two numbers.
std::int64_t median_step(std::vector<std::int64_t> numbers) {
  if (numbers.size() < 2) return 0;
  std::ranges::sort(numbers);
  std::adjacent_difference(numbers.begin(), numbers.end(), numbers.begin());
  const auto middle = numbers.begin() + 1 + static_cast<std::ptrdiff_t>((numbers.size() - 1) / 2);
  std::nth_element(numbers.begin() + 1, middle, numbers.end());
  return *middle;
}

/// Whether each number is a multiple of a step from the first one, as those of every k-th frame.
bool is_regular(const std::vector<std::int64_t>& numbers, std::int64_t step) {
  return std::ranges::all_of(numbers,
                             [&](std::int64_t number) { return (number - numbers.front()) % step == 0; });
}

/// The image of a row `t path`, or of a path with blanks, which the row has in several fields.
std::filesystem::path image_of(const eval::TextRow& row, const std::filesystem::path& root) {
  const std::string_view first = row.text(1);
  std::filesystem::path image = listed_image(root, first);
  if (row.fields.size() == 2 || std::filesystem::exists(image)) return image;
  const std::string_view last = row.fields.back();
  const std::string_view all(first.data(),
                             static_cast<std::size_t>(last.data() - first.data()) + last.size());
  const std::filesystem::path with_blanks = listed_image(root, all);
  return std::filesystem::exists(with_blanks) ? with_blanks : image;
}

}  // namespace

bool is_image(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  std::ranges::transform(extension, extension.begin(),
                         [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
  return extension == ".png" || extension == ".jpg" || extension == ".jpeg" || extension == ".tif" ||
         extension == ".tiff" || extension == ".exr";
}

std::filesystem::path listed_image(const std::filesystem::path& root, std::string_view name) {
  std::filesystem::path file = root / name;
  if (name.find('\\') == std::string_view::npos || std::filesystem::exists(file)) return file;
  std::string with_slashes(name);
  std::ranges::replace(with_slashes, '\\', '/');
  return root / with_slashes;
}

std::vector<Timestamp> times_of_frames(std::vector<std::int64_t> numbers, const std::filesystem::path& folder,
                                       NumberMeaning meaning) {
  constexpr std::int64_t kMaxStep = 10;  // a third of a second; times in ms, us and ns are further apart
  std::vector<Timestamp> times;
  const std::int64_t largest = numbers.empty() ? 0 : std::ranges::max(numbers);
  const std::int64_t step = median_step(numbers);
  const bool is_subset = meaning == NumberMeaning::kFrame && step > 0 && is_regular(numbers, step);
  if (largest > eval::kMaxFrameNumber || (step > kMaxStep && !is_subset))
    throw InputError(
        folder.string(),
        fmt::format(
            "the numbers in the names of the images, up to {} and mostly {} apart, are neither "
            "frame numbers at 30 Hz nor times since 1970 in s, ms, us or ns; rename the images to "
            "times in seconds with decimals, such as 0.033333.png, also if they are every k-th frame; "
            "or number them consecutively at 30 Hz",
            largest, step));
  for (const std::int64_t number : numbers) times.push_back(eval::time_of_frame(number));
  return times;
}

std::vector<std::filesystem::path> visible_files(const std::filesystem::path& folder) {
  std::vector<std::pair<std::string, std::filesystem::path>> by_key;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with('.')) by_key.emplace_back(natural_key(name), entry.path());
  }
  std::ranges::sort(by_key);
  std::vector<std::filesystem::path> files;
  files.reserve(by_key.size());
  for (auto& [key, file] : by_key) files.push_back(std::move(file));
  return files;
}

std::vector<StampedFile> read_image_list(const std::filesystem::path& list, const std::filesystem::path& root,
                                         eval::TimeUnit unit, FaultLog& faults) {
  const std::string text = eval::read_text_file(list);
  const std::string name = list.string();
  std::vector<StampedFile> images;
  eval::for_each_row(text, name, faults, [&](const eval::TextRow& row) {
    const StampedFile image{.t = row.time(0, unit), .file = image_of(row, root)};
    if (!images.empty()) row.require_increasing(images.back().t, image.t);
    images.push_back(image);
  });
  faults.guard([&] {
    if (images.empty()) throw InputError(name, "lists no images; is the sequence complete?");
  });
  return images;
}

namespace {

std::vector<StampedFile> read_list(const std::filesystem::path& list, FaultLog& faults) {
  return read_image_list(list, list.parent_path(), eval::TimeUnit::kSeconds, faults);
}

std::vector<Timestamp> stamps_of(const std::vector<StampedFile>& files) {
  std::vector<Timestamp> stamps;
  stamps.reserve(files.size());
  for (const StampedFile& file : files) stamps.push_back(file.t);
  return stamps;
}

}  // namespace

std::size_t color_stamp_column(const eval::TextRow& row) {
  if (row.fields.size() < 4) throw row.error("expected the four fields: stamp, image, stamp, image");
  const auto names_depth = [&row](std::size_t column) {
    return row.text(column).find("depth") != std::string_view::npos;
  };
  const bool depth_first = names_depth(1);
  if (depth_first == names_depth(3))
    throw row.error("exactly one of the two paths must contain \"depth\", to tell the depth image");
  return depth_first ? 2 : 0;
}

std::filesystem::path associations_file(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / "associations.txt";
  return std::filesystem::exists(file) ? file : folder / "associate.txt";
}

PairedImages pair_images(const std::filesystem::path& color_list, const std::filesystem::path& depth_list,
                         FaultLog& faults, MissingImages missing) {
  std::vector<StampedFile> color = read_list(color_list, faults);
  std::vector<StampedFile> depth = read_list(depth_list, faults);
  std::size_t dropped = 0;
  if (missing == MissingImages::kDrop) {
    const auto is_missing = [](const StampedFile& image) { return !std::filesystem::exists(image.file); };
    dropped = std::erase_if(color, is_missing) + std::erase_if(depth, is_missing);
  }
  PairedImages images{.times = {}, .files = {}, .color_images = color.size(), .missing = dropped};
  // The pairs are in the order of the second list, which the frame times must follow.
  for (const auto& [in_depth, in_color] :
       eval::associate_tum(stamps_of(depth), stamps_of(color), kImageAssociation)) {
    images.times.push_back(color[in_color].t);
    images.files.push_back(
        FrameFiles{.color = color[in_color].file,
                   .depth = depth[in_depth].file,
                   .depth_offset_s = seconds_between(color[in_color].t, depth[in_depth].t)});
  }
  if (images.times.empty()) {
    throw InputError(depth_list.string(), "no depth image is less than 20 ms from a color image of " +
                                              color_list.filename().string() +
                                              "; are both of the same recording?");
  }
  return images;
}

SequenceContent with_frames(SequenceContent content, const PairedImages& images) {
  content.info.frame_times = images.times;
  content.frame_files = images.files;
  if (const std::size_t unpaired = images.color_images - images.times.size(); unpaired > 0) {
    content.info.notes.push_back(std::to_string(unpaired) + " of " + std::to_string(images.color_images) +
                                 " color images have no depth image less than 20 ms away and are dropped");
  }
  if (images.missing > 0)
    content.info.warnings.push_back("images: " + counted(images.missing, "image") +
                                    " of the lists missing and dropped");
  return content;
}

}  // namespace stillpoint::datasets
