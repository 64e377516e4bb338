#include "app/formats/datasets/zarr/zarr_metadata.h"

#include "base/text.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>
#include <string_view>
#include <utility>

namespace gs::app {
namespace {

using nlohmann::json;

constexpr std::uint64_t kMostZarrExtent = std::uint64_t{1} << 48;
constexpr std::uint64_t kMostZarrChunk = std::uint64_t{1} << 30;

/// Exception for metadata that cannot be used.
struct BadZarrMetadata {
  std::string message;
};

std::string zarr_text(const json& value) { return value.is_string() ? value.get<std::string>() : std::string(); }

/// Returns a text for a message: short, without control characters.
std::string shown_in_message(const json& value) {
  std::string text =
      value.is_string() ? value.get<std::string>() : value.dump(-1, ' ', true, json::error_handler_t::replace);
  constexpr std::size_t kMost = 60;
  if (text.size() > kMost) text = text.substr(0, kMost) + "...";
  for (char& c : text)
    if (static_cast<unsigned char>(c) < ' ' || static_cast<unsigned char>(c) > '~') c = '?';
  return text;
}

std::vector<std::uint64_t> zarr_extents(const json& list, const char* name, std::uint64_t least) {
  std::vector<std::uint64_t> result;
  if (!list.is_array() || list.empty() || list.size() > kMostZarrDimensions)
    throw BadZarrMetadata{std::string(name) + " is " + shown_in_message(list) + "; expected 1 to " +
                          std::to_string(kMostZarrDimensions) + " numbers"};
  for (const json& one : list) {
    if (!one.is_number_integer() || one.get<double>() < static_cast<double>(least) ||
        one.get<double>() > static_cast<double>(kMostZarrExtent))
      throw BadZarrMetadata{std::string(name) + " is " + shown_in_message(list) + "; expected whole numbers from " +
                            std::to_string(least) + " to 2^48"};
    result.push_back(one.get<std::uint64_t>());
  }
  return result;
}

struct ZarrTypeName {
  std::string_view v2, v3;  // without the byte order
  StoredType type;
  std::size_t components = 1;
  bool half = false;
};
constexpr ZarrTypeName kZarrTypes[] = {
    {"b1", "bool", StoredType::u8},          {"u1", "uint8", StoredType::u8},
    {"i1", "int8", StoredType::i8},          {"u2", "uint16", StoredType::u16},
    {"i2", "int16", StoredType::i16},        {"u4", "uint32", StoredType::u32},
    {"i4", "int32", StoredType::i32},        {"u8", "uint64", StoredType::u64},
    {"i8", "int64", StoredType::i64},        {"f2", "float16", StoredType::f32, 1, true},
    {"f4", "float32", StoredType::f32},      {"f8", "float64", StoredType::f64},
    {"c8", "complex64", StoredType::f32, 2}, {"c16", "complex128", StoredType::f64, 2}};

void set_zarr_type(ZarrArray& array, const ZarrTypeName& name, bool big_endian) {
  array.type = {name.type, big_endian, name.half, name.components};
  array.type_name = name.v3;
}

const ZarrTypeName& zarr_type_of_v3(const json& type) {
  const std::string name = zarr_text(type);
  const auto found = std::ranges::find(kZarrTypes, name, &ZarrTypeName::v3);
  if (found == std::end(kZarrTypes))
    throw BadZarrMetadata{"its type is " + shown_in_message(type) + "; expected numbers, such as uint16 or float32"};
  return *found;
}

/// Adds a number in the byte order of the array.
template <class T>
void put_number(const ZarrArray& array, T value, std::vector<std::byte>& to) {
  std::byte bytes[sizeof(T)];
  std::memcpy(bytes, &value, sizeof(T));
  if (array.type.big_endian != (std::endian::native == std::endian::big)) std::reverse(bytes, bytes + sizeof(T));
  to.insert(to.end(), bytes, bytes + sizeof(T));
}

double zarr_real(const json& value) {
  if (value.is_number()) return value.get<double>();
  if (value.is_boolean()) return value.get<bool>() ? 1 : 0;
  const std::string text = zarr_text(value);
  if (text == "NaN") return std::numeric_limits<double>::quiet_NaN();
  if (text == "Infinity") return std::numeric_limits<double>::infinity();
  if (text == "-Infinity") return -std::numeric_limits<double>::infinity();
  return 0;
}

template <class T>
T zarr_integer(const json& value) {
  if (value.is_number_unsigned()) return static_cast<T>(value.get<std::uint64_t>());
  if (value.is_number_integer()) return static_cast<T>(value.get<std::int64_t>());
  const double real = zarr_real(value);
  if (!(real > static_cast<double>(std::numeric_limits<T>::min()))) return std::numeric_limits<T>::min();
  if (!(real < static_cast<double>(std::numeric_limits<T>::max()))) return std::numeric_limits<T>::max();
  return static_cast<T>(real);
}

/// Sets the element that stands in missing chunks; after halves became f32.
void set_zarr_fill(ZarrArray& array, const json& value) {
  with_stored_type(array.type.stored, [&](auto example) {
    using T = decltype(example);
    for (std::size_t i = 0; i < array.type.components; ++i) {
      static const json zero = 0;
      const json& part = value.is_array() ? (i < value.size() ? value[i] : zero) : value;
      if constexpr (std::is_floating_point_v<T>)
        put_number(array, static_cast<T>(zarr_real(part)), array.fill);
      else
        put_number(array, zarr_integer<T>(part), array.fill);
    }
  });
}

/// Returns the size of the numbers that the codec delta subtracts, in bytes.
std::size_t zarr_delta_bytes(const json& settings) {
  const std::string type = zarr_text(zarr_member(settings, "dtype"));
  const json& stored = zarr_member(settings, "astype");
  if (type.size() != 3 || (type[1] != 'i' && type[1] != 'u') ||
      std::string_view("1248").find(type[2]) == std::string_view::npos ||
      (stored.is_string() && zarr_text(stored) != type))
    throw BadZarrMetadata{"the codec delta has the type " + shown_in_message(zarr_member(settings, "dtype")) +
                          "; expected whole numbers, such as <i2, and an equal astype"};
  return static_cast<std::size_t>(type[2] - '0');
}

/// Checks that the codec delta fits the elements of the array.
void check_zarr_delta(const ZarrArray& array) {
  const bool whole = array.type.stored != StoredType::f32 && array.type.stored != StoredType::f64;
  for (std::size_t i = 0; i < array.codecs.size(); ++i)
    if (array.codecs[i].kind == ZarrCodec::Kind::delta &&
        (i > 0 || !whole || array.codecs[i].element != array.type.bytes()))
      throw BadZarrMetadata{
          "the codec delta does not fit the array; expected the type of the array, as the first codec"};
}

void check_zarr_array(const ZarrArray& array) {
  check_zarr_delta(array);
  if (array.chunk.size() != array.shape.size())
    throw BadZarrMetadata{"its chunks have " + std::to_string(array.chunk.size()) + " dimensions; expected " +
                          std::to_string(array.shape.size()) + ", as the array"};
  std::uint64_t bytes = array.type.bytes();
  for (const std::uint64_t extent : array.chunk) {
    if (extent > kMostZarrChunk / bytes)
      throw BadZarrMetadata{"its chunks have more than " + std::to_string(kMostZarrChunk >> 20) + " MiB each"};
    bytes *= extent;
  }
  std::uint64_t elements = 1;
  for (const std::uint64_t extent : array.shape) {
    if (extent > 0 && elements > (std::uint64_t{1} << 60) / extent) throw BadZarrMetadata{"it has too many elements"};
    elements *= std::max<std::uint64_t>(extent, 1);
  }
}

struct ZarrCodecName {
  std::string_view name;
  ZarrCodec::Kind kind;
};
constexpr ZarrCodecName kZarrCodecs[] = {
    {"gzip", ZarrCodec::Kind::gzip},       {"zlib", ZarrCodec::Kind::gzip}, {"zstd", ZarrCodec::Kind::zstd},
    {"blosc", ZarrCodec::Kind::blosc},     {"lz4", ZarrCodec::Kind::lz4},   {"bz2", ZarrCodec::Kind::bzip2},
    {"bzip2", ZarrCodec::Kind::bzip2},     {"xz", ZarrCodec::Kind::xz},     {"crc32c", ZarrCodec::Kind::crc32c},
    {"shuffle", ZarrCodec::Kind::shuffle}, {"lzma", ZarrCodec::Kind::xz},   {"delta", ZarrCodec::Kind::delta}};

void add_zarr_codec(ZarrArray& array, const std::string& given, const json& settings) {
  std::string_view name = given;
  if (name.starts_with("numcodecs.")) name.remove_prefix(10);
  const auto found = std::ranges::find(kZarrCodecs, name, &ZarrCodecName::name);
  if (found == std::end(kZarrCodecs))
    throw BadZarrMetadata{"unknown codec " + shown_in_message(json(given)) +
                          "; expected blosc, zstd, gzip, lz4, bz2, xz or crc32c"};
  ZarrCodec codec{found->kind};
  if (codec.kind == ZarrCodec::Kind::shuffle) {
    const json& size = zarr_member(settings, "elementsize");
    codec.element = size.is_number_unsigned() ? size.get<std::size_t>() : 4;
    if (codec.element == 0 || codec.element > 256)
      throw BadZarrMetadata{"the codec shuffle has an invalid element size"};
  }
  if (codec.kind == ZarrCodec::Kind::delta) codec.element = zarr_delta_bytes(settings);
  array.codecs.push_back(codec);
  array.codec_names += (array.codec_names.empty() ? "" : ", ") + std::string(name);
}

/// Reads the codecs of version 3: of an array, or of the chunks in a shard.
void add_zarr_codecs(ZarrArray& array, const json& list, const ZarrTypeName& type, bool in_shard) {
  constexpr std::size_t kMostCodecs = 16;
  if (!list.is_array() || list.empty() || list.size() > kMostCodecs)
    throw BadZarrMetadata{"its codecs are missing; expected a list, such as bytes and zstd"};
  bool has_bytes = false;
  for (const json& one : list) {
    const std::string name = one.is_string() ? zarr_text(one) : zarr_text(zarr_member(one, "name"));
    const json& settings = zarr_member(one, "configuration");
    if (name == "transpose") {
      const json& order = zarr_member(settings, "order");
      const std::size_t count = array.shape.size();
      std::vector<std::size_t> next;
      if (has_bytes) throw BadZarrMetadata{"the codec transpose follows the codec bytes"};
      if (zarr_text(order) == "F") {
        next.assign(array.order.rbegin(), array.order.rend());
      } else if (zarr_text(order) == "C") {
        next = array.order;
      } else {
        std::vector<bool> seen(count);
        if (!order.is_array() || order.size() != count) throw BadZarrMetadata{"the codec transpose has no valid order"};
        for (const json& dimension : order) {
          const auto at = dimension.is_number_unsigned() ? dimension.get<std::size_t>() : count;
          if (at >= count || seen[at]) throw BadZarrMetadata{"the codec transpose has no valid order"};
          seen[at] = true;
          next.push_back(array.order[at]);
        }
      }
      array.order = std::move(next);
    } else if (name == "bytes") {
      has_bytes = true;
      const std::string endian = zarr_text(zarr_member(settings, "endian"));
      set_zarr_type(array, type, endian == "big");
    } else if (name == "sharding_indexed") {
      if (in_shard) throw BadZarrMetadata{"its shards contain shards; expected chunks in shards"};
      if (!array.codecs.empty())
        throw BadZarrMetadata{"its shards are encoded as a whole with " + array.codec_names +
                              "; expected codecs inside of the shards"};
      if (array.order != [&] {
            std::vector<std::size_t> plain(array.shape.size());
            std::iota(plain.begin(), plain.end(), std::size_t{0});
            return plain;
          }())
        throw BadZarrMetadata{"its shards are transposed; expected the codec transpose inside of the shards"};
      ZarrShards shards{array.chunk, zarr_text(zarr_member(settings, "index_location")) != "start", false};
      array.chunk = zarr_extents(zarr_member(settings, "chunk_shape"), "chunk_shape", 1);
      if (array.chunk.size() != shards.shape.size()) throw BadZarrMetadata{"chunk_shape does not fit the shards"};
      std::uint64_t chunks = 1;
      for (std::size_t i = 0; i < array.chunk.size(); ++i) {
        if (shards.shape[i] % array.chunk[i] != 0)
          throw BadZarrMetadata{"its shards do not contain whole numbers of chunks"};
        constexpr std::uint64_t kMostChunks = std::uint64_t{1} << 22;  // an index of 64 MiB
        const std::uint64_t along = shards.shape[i] / array.chunk[i];
        if (along > kMostChunks / chunks)
          throw BadZarrMetadata{"its shards have too many chunks; expected up to 4,194,304"};
        chunks *= along;
      }
      for (const json& index : zarr_member(settings, "index_codecs")) {
        const std::string codec = zarr_text(zarr_member(index, "name"));
        if (codec == "crc32c")
          shards.index_has_checksum = true;
        else if (codec != "bytes" || zarr_text(zarr_member(zarr_member(index, "configuration"), "endian")) == "big")
          throw BadZarrMetadata{"the index of its shards is encoded with " + shown_in_message(json(codec)) +
                                "; expected bytes (little endian) and crc32c"};
      }
      array.shards = std::move(shards);
      add_zarr_codecs(array, zarr_member(settings, "codecs"), type, true);
      array.codec_names = "shards of " + array.codec_names;
      has_bytes = true;
    } else if (name == "numcodecs.delta") {
      if (has_bytes) throw BadZarrMetadata{"the codec delta follows the codec bytes; expected delta first"};
      add_zarr_codec(array, name, settings);
    } else {
      if (!has_bytes)
        throw BadZarrMetadata{"the codec " + shown_in_message(json(name)) + " comes before the codec bytes"};
      if (array.shards && !in_shard)
        throw BadZarrMetadata{"its shards are compressed as a whole with " + shown_in_message(json(name)) +
                              "; expected compression inside of the shards"};
      add_zarr_codec(array, name, settings);
    }
  }
  if (!has_bytes) throw BadZarrMetadata{"its codecs have no row \"bytes\""};
}

template <class F>
ZarrArrayResult read_guarded(F&& read) {
  try {
    ZarrArray array = read();
    check_zarr_array(array);
    return array;
  } catch (const BadZarrMetadata& bad) {
    return bad.message;
  } catch (const json::exception&) {
    return std::string("its metadata have values of unexpected types");
  }
}

void set_zarr_order(ZarrArray& array) {
  array.order.resize(array.shape.size());
  std::iota(array.order.begin(), array.order.end(), std::size_t{0});
}

}  // namespace

std::uint64_t ZarrArray::chunk_elements() const {
  return std::accumulate(chunk.begin(), chunk.end(), std::uint64_t{1}, std::multiplies<>());
}

const json& zarr_member(const json& object, const char* name) {
  static const json none;
  if (!object.is_object()) return none;
  const auto at = object.find(name);
  return at == object.end() ? none : *at;
}

json zarr_json(std::span<const std::byte> bytes) {
  if (bytes.size() > kMostZarrJson) return json(json::value_t::discarded);
  // A deep nesting is legal JSON, but no metadata.
  int depth = 0;
  const json::parser_callback_t limit = [&](int at, json::parse_event_t, json&) {
    depth = std::max(depth, at);
    return at < 64;
  };
  const std::string_view text = text_of(bytes);
  json parsed = json::parse(text.begin(), text.end(), limit, false);
  return depth < 64 ? parsed : json(json::value_t::discarded);
}

ZarrArrayResult zarr_array_of_v2(const json& source) {
  return read_guarded([&] {
    ZarrArray array;
    array.shape = zarr_extents(zarr_member(source, "shape"), "shape", 0);
    array.chunk = zarr_extents(zarr_member(source, "chunks"), "chunks", 1);
    const std::string type = zarr_text(zarr_member(source, "dtype"));
    const auto name =
        type.empty() ? std::end(kZarrTypes) : std::ranges::find(kZarrTypes, type.substr(1), &ZarrTypeName::v2);
    if (name == std::end(kZarrTypes) || std::string_view("<>|=").find(type[0]) == std::string_view::npos)
      throw BadZarrMetadata{"its type is " + shown_in_message(zarr_member(source, "dtype")) +
                            "; expected numbers, such as <u2 or <f4"};
    set_zarr_type(array, *name, type[0] == '>');
    set_zarr_fill(array, zarr_member(source, "fill_value"));
    set_zarr_order(array);
    if (zarr_text(zarr_member(source, "order")) == "F") std::ranges::reverse(array.order);
    const json& filters = zarr_member(source, "filters");
    if (filters.is_array())
      for (const json& filter : filters) add_zarr_codec(array, zarr_text(zarr_member(filter, "id")), filter);
    if (const json& compressor = zarr_member(source, "compressor"); compressor.is_object())
      add_zarr_codec(array, zarr_text(zarr_member(compressor, "id")), compressor);
    if (zarr_text(zarr_member(source, "dimension_separator")) == "/") array.key_separator = "/";
    return array;
  });
}

ZarrArrayResult zarr_array_of_v3(const json& source) {
  return read_guarded([&] {
    ZarrArray array;
    array.shape = zarr_extents(zarr_member(source, "shape"), "shape", 0);
    const json& grid = zarr_member(source, "chunk_grid");
    if (zarr_text(zarr_member(grid, "name")) != "regular")
      throw BadZarrMetadata{"its chunk grid is " + shown_in_message(zarr_member(grid, "name")) + "; expected regular"};
    array.chunk = zarr_extents(zarr_member(zarr_member(grid, "configuration"), "chunk_shape"), "chunk_shape", 1);
    if (array.chunk.size() != array.shape.size())
      throw BadZarrMetadata{"chunk_shape does not fit the shape of the array"};
    const ZarrTypeName& type = zarr_type_of_v3(zarr_member(source, "data_type"));
    set_zarr_order(array);
    add_zarr_codecs(array, zarr_member(source, "codecs"), type, false);
    set_zarr_fill(array, zarr_member(source, "fill_value"));
    const json& keys = zarr_member(source, "chunk_key_encoding");
    const bool old = zarr_text(zarr_member(keys, "name")) == "v2";
    array.key_prefix = old ? "" : "c";
    const std::string separator = zarr_text(zarr_member(zarr_member(keys, "configuration"), "separator"));
    array.key_separator = separator == "." || separator == "/" ? separator : old ? "." : "/";
    if (const json& names = zarr_member(source, "dimension_names");
        names.is_array() && names.size() == array.shape.size())
      for (const json& one : names) array.dimensions.push_back(zarr_text(one));
    return array;
  });
}

ZarrArrayResult zarr_array_of_n5(const json& source) {
  return read_guarded([&] {
    ZarrArray array;
    array.n5 = true;
    array.shape = zarr_extents(zarr_member(source, "dimensions"), "dimensions", 0);
    array.chunk = zarr_extents(zarr_member(source, "blockSize"), "blockSize", 1);
    std::ranges::reverse(array.shape);
    std::ranges::reverse(array.chunk);
    set_zarr_type(array, zarr_type_of_v3(zarr_member(source, "dataType")), true);
    set_zarr_fill(array, json(0));
    set_zarr_order(array);
    array.key_separator = "/";
    const json& compression = zarr_member(source, "compression");
    const json& kind =
        compression.is_object() ? zarr_member(compression, "type") : zarr_member(source, "compressionType");
    if (const std::string name = zarr_text(kind); !name.empty() && name != "raw")
      add_zarr_codec(array, name, compression);
    return array;
  });
}

}  // namespace gs::app
