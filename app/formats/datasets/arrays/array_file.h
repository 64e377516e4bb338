#pragma once

#include "app/base/need_bytes.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

// Interface between the program and the module that links libraries of scientific formats (docs/decisions/0048). It
// uses the standard library only, because both are built apart.
namespace gs::app {

/// Type of numbers as ArrayFile::read() gives them, in native byte order. The order is that of StoredType.
enum class NumberType : std::uint8_t { u8, i8, u16, i16, u32, i32, f32, f64, u64, i64, none };

/// Attribute of an array or a group: numbers or texts.
struct ArrayAttribute {
  std::string name;
  std::vector<double> numbers;
  std::vector<std::string> texts;
};

/// Array in a file. Each element is one number, or several of the same type.
struct ArrayInfo {
  std::string path;                  // "/data/1/meshes/E/x"
  std::vector<std::uint64_t> shape;  // slowest axis first; empty for a single element
  NumberType type = NumberType::none;
  std::uint32_t parts = 1;                // numbers of an element
  std::vector<std::string> part_names{};  // names of these numbers, or none
  std::string type_name{};                // type as stored: "f32", "u16be", "2 x f64 (r, i)", "text"
  std::vector<std::uint64_t> chunk{};     // shape of the parts that are stored together, or none
  std::vector<std::string> dimensions{};  // name of each axis, or of none; a path if it is an array of the file
  bool first_grows = false;               // programs may append along the first axis, such as steps
  std::string problem{};                  // reason why read() cannot work, or none
};

/// Box of elements of an array, slowest axis first.
struct ArrayBox {
  std::vector<std::uint64_t> first, count;
};

/// Open file of arrays. One thread at a time.
class ArrayFile {
 public:
  virtual ~ArrayFile() = default;

  /// Returns the arrays in the order of the file.
  [[nodiscard]] virtual const std::vector<ArrayInfo>& arrays() const = 0;
  /// Returns the paths of the groups without the root, in the order of the file.
  [[nodiscard]] virtual const std::vector<std::string>& groups() const = 0;
  /// Returns the attributes of an array or a group; "/" is the root. Unknown paths have none.
  [[nodiscard]] virtual std::vector<ArrayAttribute> attributes(const std::string& path) = 0;
  /// Reads the box of elements that begins at `first` and has `count` elements per axis. `to` must have its size.
  /// Returns an empty text, or a message.
  [[nodiscard]] virtual std::string read(std::size_t array, std::span<const std::uint64_t> first,
                                         std::span<const std::uint64_t> count, std::span<std::byte> to) = 0;
  /// Receives the bytes of several boxes at once, for a file on a server. read() reports problems.
  virtual void prepare(std::size_t, std::span<const ArrayBox>) {}
  /// Returns the rows of an array of characters as texts; none if it is another array, or long.
  [[nodiscard]] virtual std::vector<std::string> texts(std::size_t array);
  /// Returns an upper bound of the number of elements that were written. Other elements have the fill value. Counts the
  /// elements of all stored chunks. Returns nullopt if the bound is unknown.
  [[nodiscard]] virtual std::optional<std::uint64_t> written(std::size_t) { return std::nullopt; }
  /// Returns a message about parts that could not be read so far and are shown as missing, or an empty text.
  [[nodiscard]] virtual std::string trouble() const { return {}; }
};
inline std::vector<std::string> ArrayFile::texts(std::size_t) { return {}; }

/// Bytes of a file, with their owner.
struct ArrayBytes {
  std::shared_ptr<const void> owner;
  std::span<const std::byte> bytes;
  NeedBytes need{};  // receives missing bytes; null if all bytes are present
};
using ArrayFileResult = std::variant<std::shared_ptr<ArrayFile>, std::string>;

/// Reader of a kind of file.
struct ArrayReader {
  std::string_view name;  // "HDF5"
  /// Opens a file. Never opens a path. `cache_bytes` limits the memory for decompressed data. Returns a message on
  /// failure.
  ArrayFileResult (*open)(ArrayBytes bytes, std::size_t cache_bytes);
};

/// Form of a compressed picture, as the header of its file states it.
struct PictureForm {
  std::uint32_t rows = 0, columns = 0, samples = 1;
  std::uint32_t bits_allocated = 8, bits_stored = 8;
  bool is_signed = false;
  bool lossless = false;
};

/// Decoder of a kind of compressed pictures.
struct PictureDecoder {
  std::string_view name;  // "JPEG 2000"
  /// Decodes a picture. `to` gets native samples, those of a pixel together. Returns an empty text, or a message.
  std::string (*decode)(std::span<const std::byte> bytes, const PictureForm& form, std::vector<std::byte>& to);
};

/// Compression of chunks that the program finds in files itself.
enum class ChunkCodec : std::uint8_t { blosc, lz4, bzip2, xz, lz4_block };

/// Table of readers that the module exports, under the name kDatasetModuleEntry.
struct DatasetModule {
  static constexpr std::uint32_t kVersion = 5;  // changes with this header
  std::uint32_t version = kVersion;
  std::span<const ArrayReader> readers;
  std::span<const PictureDecoder> pictures;
  /// Unpacks bytes that become exactly those of `to`. Returns false if they do not.
  bool (*unpack)(ChunkCodec codec, std::span<const std::byte> from, std::span<std::byte> to) = nullptr;
};
using DatasetModuleEntry = const DatasetModule* (*)();
inline constexpr const char* kDatasetModuleEntry = "ghostspace_dataset_module";

/// Returns the bytes of a number; 0 for none.
[[nodiscard]] inline std::size_t size_of(NumberType type) {
  constexpr std::size_t kSizes[] = {1, 1, 2, 2, 4, 4, 4, 8, 8, 8, 0};
  return kSizes[static_cast<std::size_t>(type)];
}

}  // namespace gs::app
