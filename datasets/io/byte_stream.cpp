// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/io/byte_stream.h"

#include <system_error>

namespace stillpoint::datasets {

OutputFile::OutputFile(std::filesystem::path path)
    : path_(std::move(path)), out_(unfinished(), std::ios::binary) {
  if (!out_)
    throw InputError(path_.string(), "cannot be created; check that its folder exists and is writable");
}

OutputFile::~OutputFile() {
  if (finished_) return;
  out_.close();
  std::error_code ignored;
  std::filesystem::remove(unfinished(), ignored);
}

void OutputFile::append(std::string_view bytes) {
  out_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  position_ += bytes.size();
}

void OutputFile::overwrite(std::uint64_t position, std::string_view bytes) {
  out_.seekp(static_cast<std::streamoff>(position));
  out_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  out_.seekp(static_cast<std::streamoff>(position_));
}

void OutputFile::finish() {
  out_.close();
  std::error_code problem;
  if (out_) std::filesystem::rename(unfinished(), path_, problem);
  if (!out_ || problem)
    throw InputError(path_.string(), "cannot be written completely; check free disk space");
  finished_ = true;
}

}  // namespace stillpoint::datasets
