#pragma once

#include "app/encode/grids/grid_numbers.h"
#include "app/formats/volume/vtk_xml.h"
#include "net/files/file.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace gs::app {

/// Array of a VTK XML file, read in parts: raw or base64, appended or inline, plain or compressed by zlib. Keeps a few
/// blocks in memory. One thread.
class GridArray final : public GridNumbers {
 public:
  /// Opens an array of at least `numbers` numbers. Returns a message on failure, also for text and other compression.
  /// Safe for untrusted files: memory is bounded by the table of blocks (32 MB) and by a few blocks of at most 16 MB.
  [[nodiscard]] static std::variant<GridArray, std::string> open(std::shared_ptr<const net::RandomAccessFile> file,
                                                                 const VtkXmlHeader& header, const VtkArray& array,
                                                                 std::uint64_t numbers);

  [[nodiscard]] bool read(std::uint64_t first, std::span<double> to) override;
  [[nodiscard]] std::uint64_t size() const override { return numbers_; }

 private:
  /// Decompressed bytes of a block.
  struct Block {
    std::uint64_t number = 0, used = 0;  // `used` grows with each use
    std::vector<std::byte> bytes;
  };
  GridArray() = default;
  std::optional<std::string> find_data(const VtkXmlHeader& header, const VtkArray& array);
  std::optional<std::string> read_table();
  bool read_stored(std::uint64_t offset, std::span<std::byte> to) const;
  bool read_base64(std::uint64_t place, std::uint64_t offset, std::span<std::byte> to) const;
  [[nodiscard]] bool ends_with_padding(std::uint64_t bytes) const;
  [[nodiscard]] std::uint64_t word_at(std::span<const std::byte> bytes, std::size_t index) const;
  const Block* block(std::uint64_t number);
  bool read_bytes(std::uint64_t offset, std::span<std::byte> to);

  std::shared_ptr<const net::RandomAccessFile> file_;
  StoredType type_ = StoredType::f32;
  bool big_endian_ = false, base64_ = false, packed_ = false;
  std::size_t word_ = 4;               // bytes of a number of the header
  std::uint64_t numbers_ = 0;          // count of numbers that the caller may read
  std::uint64_t place_ = 0;            // offset of the header in the file
  std::uint64_t head_ = 0;             // bytes of the header
  std::uint64_t data_ = 0;             // offset of the data in the file, if they are a separate base64 text; else 0
  std::uint64_t block_ = 0;            // bytes of a decompressed block
  std::vector<std::uint64_t> ends_;    // ends of the compressed blocks, relative to the data
  std::uint64_t bytes_ = 0, use_ = 0;  // decompressed bytes; number of uses of blocks
  std::vector<Block> kept_;
};

}  // namespace gs::app
