// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/content_hash.h"

#include <array>
#include <bit>
#include <charconv>
#include <cstring>

namespace stillpoint {
namespace {

// Primes of the XXH64 specification.
constexpr std::uint64_t kPrime1 = 0x9E3779B185EBCA87;
constexpr std::uint64_t kPrime2 = 0xC2B2AE3D27D4EB4F;
constexpr std::uint64_t kPrime3 = 0x165667B19E3779F9;
constexpr std::uint64_t kPrime4 = 0x85EBCA77C2B2AE63;
constexpr std::uint64_t kPrime5 = 0x27D4EB2F165667C5;

static_assert(std::endian::native == std::endian::little, "the hash is defined over little-endian words");

template <class Word>
std::uint64_t word_at(std::string_view bytes) {
  Word word;
  std::memcpy(&word, bytes.data(), sizeof word);
  return word;
}

std::uint64_t round(std::uint64_t lane, std::uint64_t word) {
  return std::rotl(lane + word * kPrime2, 31) * kPrime1;
}

/// Hashes whole stripes of 32 bytes in four lanes.
std::uint64_t hash_stripes(std::string_view stripes, std::uint64_t seed) {
  std::array<std::uint64_t, 4> lanes = {seed + kPrime1 + kPrime2, seed + kPrime2, seed, seed - kPrime1};
  for (; !stripes.empty(); stripes.remove_prefix(32)) {
    for (std::size_t i = 0; i < 4; ++i)
      lanes[i] = round(lanes[i], word_at<std::uint64_t>(stripes.substr(8 * i)));
  }
  std::uint64_t hash =
      std::rotl(lanes[0], 1) + std::rotl(lanes[1], 7) + std::rotl(lanes[2], 12) + std::rotl(lanes[3], 18);
  for (const std::uint64_t lane : lanes) hash = (hash ^ round(0, lane)) * kPrime1 + kPrime4;
  return hash;
}

std::uint64_t hash_tail(std::string_view tail, std::uint64_t hash) {
  for (; tail.size() >= 8; tail.remove_prefix(8)) {
    hash = std::rotl(hash ^ round(0, word_at<std::uint64_t>(tail)), 27) * kPrime1 + kPrime4;
  }
  if (tail.size() >= 4) {
    hash = std::rotl(hash ^ (word_at<std::uint32_t>(tail) * kPrime1), 23) * kPrime2 + kPrime3;
    tail.remove_prefix(4);
  }
  for (const char byte : tail) {
    hash = std::rotl(hash ^ (static_cast<unsigned char>(byte) * kPrime5), 11) * kPrime1;
  }
  return hash;
}

}  // namespace

std::uint64_t content_hash(std::string_view bytes, std::uint64_t seed) {
  const std::size_t striped = bytes.size() / 32 * 32;
  std::uint64_t hash = striped > 0 ? hash_stripes(bytes.substr(0, striped), seed) : seed + kPrime5;
  hash = hash_tail(bytes.substr(striped), hash + bytes.size());
  hash = (hash ^ (hash >> 33)) * kPrime2;
  hash = (hash ^ (hash >> 29)) * kPrime3;
  return hash ^ (hash >> 32);
}

std::string hash_text(std::uint64_t hash) {
  std::array<char, 16> digits{};
  const auto [end, error] = std::to_chars(digits.data(), digits.data() + digits.size(), hash, 16);
  const std::string text(digits.data(), end);
  return std::string(digits.size() - text.size(), '0') + text;
}

}  // namespace stillpoint
