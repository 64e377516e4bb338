#pragma once

#include "qnv/codecs/gaussians/lod/splat_stream.h"

#include "qnv/codecs/gaussians/encode/gaussians_stream.h"
#include "qnv/reader/stream_decoder.h"
#include "tests/qnv/splat_clouds.h"

#include <catch2/catch.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace gs::qnv::splat_stream_test {

using Bytes = std::vector<std::byte>;
using Stream = std::unique_ptr<SplatStream>;

inline EncodedStream encoded_cloud(std::size_t count, int degree = 0) {
  auto encoded = encode_gaussians(test::splat_cloud(count, degree), {});
  REQUIRE(std::holds_alternative<EncodedStream>(encoded));
  return std::get<EncodedStream>(std::move(encoded));
}

inline Stream opened(SplatStream::Opened made) {
  REQUIRE(std::holds_alternative<Stream>(made));
  return std::get<Stream>(std::move(made));
}

inline Gaussians decoded(std::span<const std::byte> bytes) {
  StreamDecoder decoder;
  (void)decoder.push(bytes);
  decoder.finish();
  Geometry geometry = decoder.geometry();
  REQUIRE(geometry.as<Gaussians>());
  return std::move(*geometry.as<Gaussians>());
}

/// Numbers of a Gaussian, for sorting.
using Numbers = std::array<float, 10>;

inline std::vector<Numbers> sorted_numbers(const Gaussians& all) {
  std::vector<Numbers> numbers;
  const std::size_t per = harmonic_count(all.degree);
  for (std::size_t i = 0; i < all.size(); ++i) {
    const glm::vec3 &p = all.positions[i], &s = all.scales[i];
    const glm::vec3 last = per > 0 ? all.harmonics[i * per + per - 1] : glm::vec3(0);
    numbers.push_back({p.x, p.y, p.z, s.x, s.y, s.z, all.opacities[i], all.bases[i].y, last.x, last.z});
  }
  std::ranges::sort(numbers);
  return numbers;
}

/// Returns the Gaussians of a cut. Requires that none fades.
inline Gaussians gathered(const std::vector<SplatRun>& runs) {
  Gaussians all;
  for (const SplatRun& run : runs) all.degree = std::max(all.degree, run.splats->degree);
  const std::size_t per = harmonic_count(all.degree);
  for (const SplatRun& run : runs) {
    REQUIRE(std::size_t{run.first} + run.count <= run.splats->size());
    CHECK(run.presence == 1);
    for (std::size_t i = run.first; i < std::size_t{run.first} + run.count; ++i) {
      all.positions.push_back(run.splats->positions[i]);
      all.scales.push_back(run.splats->scales[i]);
      all.opacities.push_back(run.splats->opacities[i]);
      all.bases.push_back(run.splats->bases[i]);
      for (std::size_t k = 0; k < per; ++k)
        all.harmonics.push_back(run.splats->degree > 0 ? run.splats->harmonics[i * per + k] : glm::vec3(0));
    }
  }
  return all;
}

inline std::size_t count_of(const std::vector<SplatRun>& runs) {
  std::size_t count = 0;
  for (const SplatRun& run : runs) count += run.count;
  return count;
}

inline double opacity_area(const Gaussians& all) {
  double sum = 0;
  for (std::size_t i = 0; i < all.size(); ++i)
    sum += double{all.opacities[i]} * double{all.scales[i].x} * double{all.scales[i].y};
  return sum;
}

/// Returns an unbounded view from the distance `away`.
inline LodView view_from(float away, std::uint32_t viewport = 0) {
  LodView view;
  view.eye = {0, 0, away};
  view.pixels = 1000;
  view.viewport = viewport;
  return view;
}

inline LodView closest_view() {
  LodView view = view_from(0);
  view.error_pixels = 0;
  return view;
}

/// Source that counts the bytes read from it.
class CountingSource final : public ChunkSource {
 public:
  explicit CountingSource(Bytes bytes) : bytes_(memory_source(std::move(bytes))) {}
  [[nodiscard]] std::uint64_t size() const override { return bytes_->size(); }
  [[nodiscard]] std::size_t read(std::uint64_t offset, std::span<std::byte> to) const override {
    const std::size_t count = bytes_->read(offset, to);
    read_ += count;
    return count;
  }
  mutable std::atomic<std::size_t> read_ = 0;

 private:
  std::shared_ptr<const ChunkSource> bytes_;
};

/// Source with bytes that a test changes.
class ChangedSource final : public ChunkSource {
 public:
  explicit ChangedSource(Bytes bytes) : bytes_(std::move(bytes)) {}
  [[nodiscard]] std::uint64_t size() const override { return bytes_.size(); }
  [[nodiscard]] std::size_t read(std::uint64_t offset, std::span<std::byte> to) const override {
    const std::size_t first = static_cast<std::size_t>(std::min<std::uint64_t>(offset, bytes_.size()));
    const std::size_t count = std::min(to.size(), bytes_.size() - first);
    std::copy_n(bytes_.begin() + static_cast<std::ptrdiff_t>(first), count, to.begin());
    return count;
  }
  Bytes bytes_;
};

/// Returns the chunks of Gaussians and harmonics of a stream, with their offsets.
inline std::vector<std::pair<std::uint64_t, Bytes>> chunks_of(const EncodedStream& stream) {
  std::vector<std::pair<std::uint64_t, Bytes>> chunks;
  StreamReader reader;
  (void)reader.push(stream.bytes, [&](ChunkType type, std::span<const std::byte> payload, std::uint64_t offset) {
    if (type == ChunkType::gaussians || is_harmonics(type)) chunks.emplace_back(offset, encode_chunk(type, payload));
  });
  return chunks;
}

inline Bytes directory_bytes(const EncodedStream& stream) {
  return {stream.bytes.begin() + static_cast<std::ptrdiff_t>(stream.header.directory), stream.bytes.end()};
}

}  // namespace gs::qnv::splat_stream_test
