// SPDX-License-Identifier: BSD-3-Clause
/// Lists of image files with timestamps, and the frames of the formats that list color and depth images
/// separately.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string_view>
#include <vector>

#include "core/base/error.h"
#include "core/base/timestamp.h"
#include "datasets/formats/formats.h"
#include "eval/io/text_reader.h"
#include "eval/trajectory/association.h"

namespace stillpoint::datasets {

/// The entries of a folder in natural order: runs of digits are compared as numbers, "frame9" < "frame10".
/// Without hidden files, whose names begin with ".": macOS adds "._5.png" to "5.png", which is no image.
/// @throws std::filesystem::filesystem_error if the folder cannot be read
[[nodiscard]] std::vector<std::filesystem::path> visible_files(const std::filesystem::path& folder);

/// Whether the name of a file ends as that of an image.
[[nodiscard]] bool is_image(const std::filesystem::path& file);

/// What the numbers in the names of images are: unknown, or frame numbers by the definition of the layout.
enum class NumberMeaning { kUnknown, kFrame };

/// Times of images without a stamp: frame number / 30 s.
/// @param numbers in the names of images, in any order
/// @param folder for messages
/// @param meaning of frame numbers, a folder may have every k-th one only
/// @throws InputError if the numbers are too large, or most of them too far apart, to be those of frames
[[nodiscard]] std::vector<Timestamp> times_of_frames(std::vector<std::int64_t> numbers,
                                                     const std::filesystem::path& folder,
                                                     NumberMeaning meaning = NumberMeaning::kUnknown);

struct StampedFile {
  Timestamp t;
  std::filesystem::path file;
};

/// The file that a list names, relative to `root`. Lists of Windows have backslashes.
[[nodiscard]] std::filesystem::path listed_image(const std::filesystem::path& root, std::string_view name);

/// Reads rows `t path`, paths relative to `root`. The images need not exist. Paths of existing images may
/// contain blanks.
/// @param list text file; `unit` is the unit of its stamps
/// @return strictly increasing in time, not empty
/// @throws InputError if the list is missing, empty or unsorted
[[nodiscard]] std::vector<StampedFile> read_image_list(const std::filesystem::path& list,
                                                       const std::filesystem::path& root, eval::TimeUnit unit,
                                                       FaultLog& faults);

/// Of color and depth images: the default of the tools of the TUM RGB-D benchmark.
inline constexpr eval::AssociationOptions kImageAssociation{.max_difference_s = 0.02};

/// The frames of a sequence.
struct PairedImages {
  std::vector<Timestamp> times;
  std::vector<FrameFiles> files;  ///< one per time
  std::size_t color_images = 0;   ///< of the list, including those without depth
  std::size_t missing = 0;        ///< listed images that do not exist and were dropped
};

/// Whether listed images that do not exist are dropped before pairing; else decoding reports them.
enum class MissingImages { kKeep, kDrop };

/// Pairs the images of two lists, less than 20 ms apart, into frames with the timestamp of the color image,
/// as `eval::associate_tum` does. Color images without depth are dropped.
/// @throws InputError if a list is missing, empty or unsorted, or there are no pairs
[[nodiscard]] PairedImages pair_images(const std::filesystem::path& color_list,
                                       const std::filesystem::path& depth_list, FaultLog& faults,
                                       MissingImages missing = MissingImages::kKeep);

/// `content` with the frames, and a note on the color images that were dropped.
[[nodiscard]] SequenceContent with_frames(SequenceContent content, const PairedImages& images);

/// Of a row `stamp image stamp image` of associate.py, color or depth first: the column of the stamp of the
/// color image, 0 or 2. The path of the depth image contains "depth".
/// @throws InputError if the row has fewer fields, or not exactly one path contains "depth"
[[nodiscard]] std::size_t color_stamp_column(const eval::TextRow& row);

/// The list of pairs that associate.py writes, associations.txt or associate.txt, which may not exist.
[[nodiscard]] std::filesystem::path associations_file(const std::filesystem::path& folder);

}  // namespace stillpoint::datasets
