#pragma once

#include "qnv/codecs/encode.h"
#include "qnv/codecs/values/decode/values_slices.h"
#include "qnv/reader/stream_decoder.h"
#include "qnv/sampling/volume/volume_slices.h"
#include "qnv/sampling/volume/volume_values.h"

#include <catch2/catch.hpp>

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <span>
#include <utility>
#include <variant>
#include <vector>

namespace gs::test {

/// Returns the stream of an encoder, which must have succeeded.
inline qnv::EncodedStream encoded_stream(std::variant<qnv::EncodedStream, qnv::EncodeError> encoded) {
  const auto* problem = std::get_if<qnv::EncodeError>(&encoded);
  INFO((problem ? problem->message : ""));
  REQUIRE_FALSE(problem);
  return std::get<qnv::EncodedStream>(std::move(encoded));
}

/// Returns the chunks of a stream with their types, without its directory and parity.
inline std::vector<std::pair<qnv::ChunkType, std::vector<std::byte>>> content_chunks(
    std::span<const std::byte> stream) {
  std::vector<std::pair<qnv::ChunkType, std::vector<std::byte>>> chunks;
  qnv::StreamReader reader;
  (void)reader.push(stream, [&](qnv::ChunkType type, std::span<const std::byte> payload, std::uint64_t) {
    if (type != qnv::ChunkType::directory && type != qnv::ChunkType::parity)
      chunks.emplace_back(type, std::vector(payload.begin(), payload.end()));
  });
  return chunks;
}

/// Opens the slices of a stream, which are decoded when they are read. `bytes` must outlive the result.
inline std::shared_ptr<const qnv::VolumeValues> slices_of(const std::vector<std::byte>& bytes) {
  const auto opened = qnv::open_values_slices({bytes.size(), [&bytes](std::uint64_t offset, std::span<std::byte> to) {
                                                 std::memcpy(to.data(), bytes.data() + offset, to.size());
                                                 return true;
                                               }});
  REQUIRE(std::holds_alternative<std::shared_ptr<const qnv::VolumeValues>>(opened));
  return std::get<std::shared_ptr<const qnv::VolumeValues>>(opened);
}

/// Returns the values of all voxels; NaN where they are missing.
inline std::vector<float> values_in(const qnv::VolumeSource& source) {
  std::vector<float> all(qnv::voxel_count(source.layout));
  std::vector<std::byte> scratch;
  const std::size_t slice = qnv::slice_voxels(source.layout);
  for (std::uint32_t z = 0; z < source.layout.dimensions[2]; ++z)
    REQUIRE(qnv::read_slice(source, z, scratch, std::span(all).subspan(z * slice, slice)));
  return all;
}

/// Returns the bits of floats, so that gaps and signs compare, too.
inline std::vector<std::uint32_t> bits_of(const std::vector<float>& values) {
  std::vector<std::uint32_t> bits;
  for (const float value : values) bits.push_back(value == value ? std::bit_cast<std::uint32_t>(value) : 0xffffffffu);
  return bits;
}

/// Volume that the bytes of a stream give, with its values.
struct ShownValues {
  explicit ShownValues(std::span<const std::byte> bytes, std::size_t most_vectors = std::size_t{1} << 26)
      : decoder(most_vectors) {
    decoder.push(bytes);
    decoder.finish();
    geometry = decoder.geometry();
    const auto* volume = geometry.as<qnv::Volume>();
    REQUIRE(volume);
    REQUIRE(volume->values);
    values = volume->values;
  }
  qnv::StreamDecoder decoder;
  qnv::Geometry geometry;
  std::shared_ptr<const qnv::VolumeValues> values;
};

}  // namespace gs::test
