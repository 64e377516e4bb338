#pragma once

#include "app/formats/volume/volume_common.h"

#include <nlohmann/json_fwd.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

// Metadata of arrays in Zarr version 2 (https://zarr-specs.readthedocs.io/en/latest/v2/v2.0.html), version 3
// (.../v3/core/v3.0.html) and N5 (https://github.com/saalfeldlab/n5).
namespace gs::app {

/// Maximum number of dimensions of an array.
inline constexpr std::size_t kMostZarrDimensions = 16;

/// Number type of an array.
struct ZarrType {
  StoredType stored = StoredType::u8;  // of one component, as it leaves the codecs
  bool big_endian = false;
  bool half = false;           // stored as binary16; `stored` is f32
  std::size_t components = 1;  // 2 for complex numbers

  /// Returns the bytes of an element before and after halves become f32.
  [[nodiscard]] std::size_t encoded_bytes() const { return (half ? 2 : size_of(stored)) * components; }
  [[nodiscard]] std::size_t bytes() const { return size_of(stored) * components; }
};

/// Step of the encoding of a chunk that turns bytes into other bytes. `delta` stores the differences of neighbouring
/// whole numbers.
struct ZarrCodec {
  enum class Kind : std::uint8_t { gzip, zstd, blosc, lz4, bzip2, xz, crc32c, shuffle, delta } kind{};
  std::size_t element = 1;  // shuffle and delta: bytes of an element
};

/// Chunks inside of shards: each file of the array holds several chunks, with an index at its end or start.
struct ZarrShards {
  std::vector<std::uint64_t> shape;  // of a shard
  bool index_at_end = true;
  bool index_has_checksum = true;
};

/// Array of a Zarr or N5 container: how elements are found in files.
struct ZarrArray {
  std::vector<std::uint64_t> shape;  // the last dimension varies fastest
  std::vector<std::uint64_t> chunk;  // shape of a chunk
  ZarrType type;
  std::vector<std::byte> fill;     // encoded element for missing chunks
  std::vector<std::size_t> order;  // order of the dimensions in a chunk; the last one varies fastest
  std::vector<ZarrCodec> codecs;   // in the order in which the encoder applied them
  std::optional<ZarrShards> shards;
  std::string key_prefix, key_separator = ".";
  bool n5 = false;                      // chunks have headers, and may be smaller at the end of the array
  std::vector<std::string> dimensions;  // their names; empty if unknown
  std::string codec_names;              // for reports: "blosc"
  std::string type_name;                // "uint16"

  [[nodiscard]] std::uint64_t chunk_elements() const;
  /// Returns the number of chunks along a dimension.
  [[nodiscard]] std::uint64_t chunks(std::size_t dimension) const {
    return (shape[dimension] + chunk[dimension] - 1) / chunk[dimension];
  }
};

/// Array, or the reason why it cannot be read. Safe for untrusted metadata.
using ZarrArrayResult = std::variant<ZarrArray, std::string>;

/// Reads the content of a file .zarray (version 2).
[[nodiscard]] ZarrArrayResult zarr_array_of_v2(const nlohmann::json& array);
/// Reads the content of a file zarr.json of an array (version 3).
[[nodiscard]] ZarrArrayResult zarr_array_of_v3(const nlohmann::json& array);
/// Reads the content of a file attributes.json of an array (N5). The dimensions are reversed, so that the last one
/// varies fastest.
[[nodiscard]] ZarrArrayResult zarr_array_of_n5(const nlohmann::json& array);

/// Returns a member of an object; a null value if there is none.
[[nodiscard]] const nlohmann::json& zarr_member(const nlohmann::json& object, const char* name);
/// Parses JSON with at most kMostZarrJson bytes. Returns a discarded value if it is malformed.
[[nodiscard]] nlohmann::json zarr_json(std::span<const std::byte> bytes);
inline constexpr std::size_t kMostZarrJson = std::size_t{64} << 20;

/// Decodes the bytes of a chunk into `elements` elements, in the order of the chunk. Halves become f32. Returns a
/// message on failure.
[[nodiscard]] std::variant<std::vector<std::byte>, std::string> decode_zarr_chunk(const ZarrArray& array,
                                                                                  std::span<const std::byte> bytes,
                                                                                  std::uint64_t elements);
/// Checks a CRC-32C at the end of bytes, and returns the bytes before it. Returns nullopt if they differ.
[[nodiscard]] std::optional<std::span<const std::byte>> without_crc32c(std::span<const std::byte> bytes);

}  // namespace gs::app
