// SPDX-License-Identifier: BSD-3-Clause
/// Keeps the decoded gray and depth images of sequences on disk: written by the first run while it decodes
/// them (`FrameCache`), or while a sequence is rendered, so that its first run decodes nothing
/// (`FrameCacheFill`).
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "core/types/frame.h"
#include "datasets/cache/cache_key.h"
#include "datasets/cache/cache_space.h"
#include "datasets/cache/frame_cache_options.h"
#include "datasets/cache/frame_file.h"
#include "datasets/formats/formats.h"

namespace stillpoint::datasets {

/// Decodes the files of a frame; thread-safe.
struct FrameDecoder {
  std::function<Frame(std::size_t index)> frame;
  std::function<cv::Mat(std::size_t index)> color;
};

/// The cached frames of one opened sequence.
///
/// A file is found by the key of its content, see cache_key.h, for which the digests of all images must be
/// known. They are remembered from the first run, which writes both while it decodes, so no image is read
/// twice. Files are complete when they get their name; several processes can read one file, and only one
/// writes it. A damaged block is decoded again, and the file is replaced by a copy that contains it. Without
/// space, or if a file cannot be read or written, frames are decoded as without a cache, with a warning.
class FrameCache {
 public:
  /// @param content must outlive this object
  FrameCache(const SequenceContent& content, FrameCacheOptions options, FrameDecoder decoder);

  /// The frame with the same bits as `decoder.frame` returns, except that the color image of a cached frame
  /// is decoded on demand. Thread-safe; the frame must not outlive this object.
  /// @throws InputError as `decoder.frame`
  [[nodiscard]] Frame load(std::size_t index);

  /// Whether all frames that will be read are in the cache.
  [[nodiscard]] bool complete() const;

 private:
  using Reader = std::shared_ptr<const FrameFileReader>;

  void open();
  [[nodiscard]] std::vector<FrameDigest> known_digests();
  [[nodiscard]] Reader open_file(std::size_t frames);
  [[nodiscard]] Reader reader() const;
  [[nodiscard]] std::optional<Frame> find(std::size_t index);
  [[nodiscard]] bool wants(std::size_t index) const;
  void store(std::size_t index, const std::optional<PackedFrame>& frame,
             const std::optional<FrameDigest>& digest);
  void append(std::size_t index, const std::optional<PackedFrame>& frame);
  void finish();
  void repair(const FrameFileReader& damaged);
  std::size_t copy_undamaged_blocks(const FrameFileReader& damaged);
  [[nodiscard]] std::unique_ptr<FrameFileWriter> create_writer();
  [[nodiscard]] std::optional<FrameDigest> digest_frame(std::size_t index);
  void disable(const std::string& reason);

  const SequenceContent& content_;
  FrameCacheOptions options_;
  FrameDecoder decoder_;
  std::size_t frames_;  ///< frames from the start that the file has or will have
  CacheSpace space_;
  mutable std::mutex mutex_;  ///< guards the members below
  std::optional<FileDigests> digests_;
  std::vector<FrameDigest> frame_digests_;
  Reader reader_;
  std::unique_ptr<FrameFileWriter> writer_;
  bool writing_ = false;   ///< whether decoded frames are written
  bool repaired_ = false;  ///< whether a damaged file was found
};

/// Writes the cache file of a sequence while it is rendered. Problems end the writing with a warning; the
/// first run decodes the images then.
class FrameCacheFill {
 public:
  /// @param sequence name for listings; renderings with the same name are not written at the same time
  FrameCacheFill(FrameCacheOptions options, std::string sequence);

  /// Adds the images as the decoder will return them. Thread-safe, in any order of frames.
  /// @param color CV_8UC3 (R, G, B)
  /// @param depth CV_16UC1, registered
  void add(std::size_t index, const cv::Mat& color, const cv::Mat& depth);

  /// Number of frames that were written.
  [[nodiscard]] std::size_t frames() const;

  /// Completes the file with the digests of the image files, which are read but not decoded.
  /// @param content the sequence as it was read back
  void finish(const SequenceContent& content);

 private:
  void write(std::size_t index, cv::Size size, const PackedFrame& frame);
  void stop(const std::string& reason);

  FrameCacheOptions options_;
  std::string sequence_;
  CacheSpace space_;
  mutable std::mutex mutex_;
  std::unique_ptr<FrameFileWriter> writer_;
  bool stopped_ = false;
};

}  // namespace stillpoint::datasets
