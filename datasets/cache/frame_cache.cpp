// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/cache/frame_cache.h"

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>

#include "core/base/content_hash.h"
#include "core/base/error.h"
#include "datasets/io/image_io.h"

namespace stillpoint::datasets {
namespace {

namespace fs = std::filesystem;

/// Files that may be read to complete the digests: those that were written just before the digests were
/// saved, or that a user touched.
constexpr int kMaxDigestedFiles = 16;

std::size_t frames_to_cache(const SequenceContent& content, const FrameCacheOptions& options) {
  const std::vector<Timestamp>& times = content.info.frame_times;
  std::size_t frames = content.frame_files.size();
  if (options.max_frames > 0) frames = std::min(frames, options.max_frames);
  if (options.max_seconds > 0.0 && frames > 0) {
    const auto end = std::ranges::lower_bound(times, after(times.front(), options.max_seconds));
    frames = std::min(frames, static_cast<std::size_t>(end - times.begin()));
  }
  return frames;
}

bool has_expected_images(const Frame& frame, const Camera& camera) {
  const cv::Size size(camera.width, camera.height);
  return frame.gray.type() == CV_8UC1 && frame.gray.size() == size &&
         (frame.depth.empty() || (frame.depth.type() == CV_16UC1 && frame.depth.size() == size));
}

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

FrameCache::FrameCache(const SequenceContent& content, FrameCacheOptions options, FrameDecoder decoder)
    : content_(content),
      options_(std::move(options)),
      decoder_(std::move(decoder)),
      frames_(frames_to_cache(content, options_)),
      space_(options_) {
  try {
    open();
  } catch (const std::exception& error) {  // of the file system, or InputError
    disable(error.what());
  }
}

void FrameCache::open() {
  fs::create_directories(options_.folder);
  digests_.emplace(content_.info.folder, digests_file(options_.folder, content_.info.folder));
  frame_digests_ = known_digests();
  const std::size_t all = content_.frame_files.size();
  reader_ = open_file(all);
  if (reader_) frames_ = all;
  if (!reader_ && frames_ < all) reader_ = open_file(frames_);
  if (reader_) return;
  frame_digests_.resize(all);
  writing_ = frames_ > 0;
}

/// The digests of the frames from the first on, as far as they are remembered.
std::vector<FrameDigest> FrameCache::known_digests() {
  if (content_.images) {
    std::vector<FrameDigest> digests;
    for (std::size_t i = 0; i < content_.frame_files.size(); ++i)
      digests.push_back(content_.images->digest(i));
    return digests;
  }
  int digested = 0;
  const auto digest_of = [&](const fs::path& file) -> std::optional<std::uint64_t> {
    std::optional<std::uint64_t> known = file.empty() ? kNoFileDigest : digests_->find(file);
    if (known || digested == kMaxDigestedFiles) return known;
    const std::optional<FileDigest> digest = digest_of_file(file);
    if (!digest) return std::nullopt;
    ++digested;
    digests_->add(file, *digest);
    return digest->digest;
  };
  std::vector<FrameDigest> frames;
  for (const FrameFiles& files : content_.frame_files) {
    const std::optional<std::uint64_t> color = digest_of(files.color);
    const std::optional<std::uint64_t> depth = color ? digest_of(files.depth) : std::nullopt;
    if (!depth) break;
    frames.push_back({.color = *color, .depth = *depth});
  }
  if (digested > 0) digests_->save();
  return frames;
}

/// The file of the first `frames` frames, if their digests are known and it exists.
FrameCache::Reader FrameCache::open_file(std::size_t frames) {
  if (frame_digests_.size() < frames) return nullptr;
  const std::uint64_t key = cache_key(content_, std::span(frame_digests_).first(frames));
  const fs::path file = frame_file(options_.folder, key);
  if (!fs::exists(file)) return nullptr;
  try {
    auto reader = std::make_shared<const FrameFileReader>(file);
    reader->mark_used();
    return reader;
  } catch (const InputError& error) {
    if (options_.warn) options_.warn(std::string(error.what()) + "; the frames are decoded again");
    return nullptr;
  }
}

FrameCache::Reader FrameCache::reader() const {
  const std::scoped_lock lock(mutex_);
  return reader_;
}

bool FrameCache::complete() const {
  const std::scoped_lock lock(mutex_);
  return reader_ != nullptr && !writing_;
}

Frame FrameCache::load(std::size_t index) {
  if (std::optional<Frame> frame = find(index)) return std::move(*frame);
  if (!wants(index)) return decoder_.frame(index);
  const std::optional<FrameDigest> digest = digest_frame(index);
  Frame frame;
  try {
    frame = decoder_.frame(index);
  } catch (const InputError&) {
    store(index, std::nullopt, digest);
    throw;
  }
  if (has_expected_images(frame, content_.info.rig.camera)) store(index, pack_frame(frame), digest);
  return frame;
}

std::optional<Frame> FrameCache::find(std::size_t index) {
  const Reader file = reader();
  if (!file || !file->contains(index)) return std::nullopt;
  const std::optional<PackedFrame> packed = file->read(index);
  const cv::Size size(file->info().width, file->info().height);
  const std::optional<cv::Mat> gray = packed ? unpack_gray(packed->gray(), size) : std::nullopt;
  const bool has_depth = packed && !packed->depth().empty();
  const std::optional<cv::Mat> depth = has_depth ? unpack_depth(packed->depth(), size) : std::nullopt;
  if (!gray || has_depth != depth.has_value()) {
    repair(*file);
    return std::nullopt;
  }
  Frame frame;
  frame.id = static_cast<std::int64_t>(index);
  frame.t = content_.info.frame_times[index];
  frame.gray = *gray;
  if (depth) frame.depth = *depth;
  frame.depth_units_per_m = content_.info.rig.depth_units_per_m;
  if (packed->has_color) frame.decode_color = [this, index] { return decoder_.color(index); };
  return frame;
}

bool FrameCache::wants(std::size_t index) const {
  const std::scoped_lock lock(mutex_);
  return writing_ && index < frames_ && !(writer_ && writer_->contains(index));
}

/// Digests of the files of a frame; nullopt if one changed while it was read.
std::optional<FrameDigest> FrameCache::digest_frame(std::size_t index) {
  if (content_.images) return content_.images->digest(index);
  const FrameFiles& files = content_.frame_files[index];
  const std::optional<FileDigest> color = digest_of_file(files.color);
  const std::optional<FileDigest> depth = files.depth.empty() ? FileDigest{} : digest_of_file(files.depth);
  if (!color || !depth) return std::nullopt;
  const std::scoped_lock lock(mutex_);
  digests_->add(files.color, *color);
  if (!files.depth.empty()) digests_->add(files.depth, *depth);
  return FrameDigest{.color = color->digest, .depth = depth->digest};
}

/// @param frame nullopt if it cannot be decoded
void FrameCache::store(std::size_t index, const std::optional<PackedFrame>& frame,
                       const std::optional<FrameDigest>& digest) {
  const std::scoped_lock lock(mutex_);
  if (!writing_ || (writer_ && writer_->contains(index))) return;  // another thread was faster
  const FrameFiles& files = content_.frame_files[index];
  const auto unchanged = [&] {
    if (content_.images) return content_.images->digest(index) == *digest;
    return digests_->find(files.color) == digest->color &&
           (files.depth.empty() || digests_->find(files.depth) == digest->depth);
  };
  if (!digest || !unchanged())
    return disable(files.color.string() + ": the images of the frame changed while they were read");
  try {
    if (!writer_) writer_ = create_writer();
    if (!writer_) {
      writing_ = false;
      return;
    }
    frame_digests_[index] = *digest;
    append(index, frame);
    if (writer_->frames() == frames_) finish();
  } catch (const std::exception& error) {
    disable(error.what());
  }
}

void FrameCache::append(std::size_t index, const std::optional<PackedFrame>& frame) {
  if (!frame) return writer_->append_unreadable(index);
  // All frames of a sequence have about the same size.
  if (writer_->frames() == 0) space_.expect(frame->images.size() * frames_);
  writer_->append(index, *frame);
}

/// Null if another process writes the frames of the same folder.
std::unique_ptr<FrameFileWriter> FrameCache::create_writer() {
  remove_abandoned_files(options_.folder);
  fs::path partial = digests_file(options_.folder, content_.info.folder);
  partial.replace_extension(std::to_string(frames_) + kPartialExtension);
  const Camera& camera = content_.info.rig.camera;
  space_ = CacheSpace(options_);
  return FrameFileWriter::create(
      partial, {.sequence = content_.info.name, .width = camera.width, .height = camera.height},
      [this](std::uint64_t bytes) { space_.require(bytes); });
}

void FrameCache::finish() {
  const std::uint64_t key = cache_key(content_, std::span(frame_digests_).first(frames_));
  const fs::path file = frame_file(options_.folder, key);
  writer_->finish(file);
  writing_ = false;
  digests_->save();
  reader_ = std::make_shared<const FrameFileReader>(file);
  writer_.reset();
}

void FrameCache::repair(const FrameFileReader& damaged) {
  const std::scoped_lock lock(mutex_);
  if (repaired_) return;
  repaired_ = true;
  std::string action = "they are decoded again";
  std::size_t bad_blocks = 0;
  try {
    writer_ = create_writer();
    if (writer_) {
      writing_ = true;
      bad_blocks = copy_undamaged_blocks(damaged);
      action += ", and the file is replaced";
    }
  } catch (const std::exception& error) {
    disable(error.what());
  }
  if (!options_.warn) return;
  options_.warn(damaged.file().string() + ": " +
                (bad_blocks > 0 ? std::to_string(bad_blocks) : std::string("some")) + " of " +
                std::to_string(damaged.frames()) + " cached frames are damaged; " + action);
}

/// @return number of damaged blocks
std::size_t FrameCache::copy_undamaged_blocks(const FrameFileReader& damaged) {
  std::size_t bad_blocks = 0;
  for (std::size_t i = 0; i < damaged.frames(); ++i) {
    if (!damaged.contains(i)) {
      append(i, std::nullopt);
      continue;
    }
    const std::optional<PackedFrame> packed = damaged.read(i);
    if (packed) append(i, packed);
    bad_blocks += !packed;
  }
  return bad_blocks;
}

/// From then on, frames that are not in the file are decoded.
void FrameCache::disable(const std::string& reason) {
  writer_.reset();
  writing_ = false;
  if (options_.warn) options_.warn(reason + "; the run continues without writing the frame cache");
}

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

std::size_t FrameCacheFill::frames() const {
  const std::scoped_lock lock(mutex_);
  return writer_ ? writer_->frames() : 0;
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
