// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/cache/frame_cache_fill.h"

#include <filesystem>
#include <utility>
#include <vector>

#include "core/base/content_hash.h"
#include "core/base/error.h"
#include "datasets/cache/cache_key.h"
#include "datasets/cache/file_digests.h"
#include "datasets/io/image_io.h"

namespace stillpoint::datasets {
namespace {

namespace fs = std::filesystem;

/// Digests of all images, which are remembered as well.
std::vector<FrameDigest> digest_images(const SequenceContent& content, FileDigests& digests) {
  const auto digest = [&digests](const fs::path& file) {
    const std::optional<FileDigest> result = digest_of_file(file);
    if (!result) throw InputError(file.string(), "cannot be read, or changed while it was read");
    digests.add(file, *result);
    return result->digest;
  };
  std::vector<FrameDigest> frames;
  for (const FrameFiles& files : content.frame_files)
    frames.push_back({.color = digest(files.color), .depth = digest(files.depth)});
  return frames;
}

}  // namespace

FrameCacheFill::FrameCacheFill(FrameCacheOptions options, std::string sequence)
    : options_(std::move(options)), sequence_(std::move(sequence)), space_(options_) {}

void FrameCacheFill::add(std::size_t index, const cv::Mat& color, const cv::Mat& depth) {
  Frame frame;
  frame.gray = to_gray(color);
  frame.color = color;
  frame.depth = depth;
  const PackedFrame packed = pack_frame(frame);
  const std::scoped_lock lock(mutex_);
  if (stopped_) return;
  try {
    write(index, color.size(), packed);
  } catch (const std::exception& error) {
    stop(error.what());
  }
}

void FrameCacheFill::write(std::size_t index, cv::Size size, const PackedFrame& frame) {
  if (!writer_) {
    fs::create_directories(options_.folder);
    const fs::path partial =
        options_.folder / ("rendering-" + hash_text(content_hash(sequence_)) + kPartialExtension);
    writer_ =
        FrameFileWriter::create(partial, {.sequence = sequence_, .width = size.width, .height = size.height},
                                [this](std::uint64_t bytes) { space_.require(bytes); });
  }
  if (writer_) {
    writer_->append(index, frame);
  } else {
    stopped_ = true;  // another process renders the same sequence
  }
}

bool FrameCacheFill::has_frames() const {
  const std::scoped_lock lock(mutex_);
  return writer_ != nullptr;
}

void FrameCacheFill::finish(const SequenceContent& content) {
  const std::scoped_lock lock(mutex_);
  if (!writer_) return;
  try {
    STILLPOINT_CHECK(writer_->frames() == content.frame_files.size());
    FileDigests digests(content.info.folder, digests_file(options_.folder, content.info.folder));
    writer_->finish(frame_file(options_.folder, cache_key(content, digest_images(content, digests))));
    digests.save();
  } catch (const std::exception& error) {
    stop(error.what());
  }
  writer_.reset();
}

void FrameCacheFill::stop(const std::string& reason) {
  stopped_ = true;
  writer_.reset();
  if (options_.warn) options_.warn(reason + "; the first run will decode the images");
}

}  // namespace stillpoint::datasets
