#include "app/encode/grids/grid_array.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <utility>

// Layout: https://docs.vtk.org/en/latest/vtk_file_formats/vtkxml_file_format.html
namespace gs::app {
namespace {

// Bytes of a block of plain data. A multiple of the sizes of all types, and of 3 bytes, a group of base64.
constexpr std::uint64_t kPlainBlock = 3 << 15;
constexpr std::uint64_t kMostGridBlock = std::uint64_t{16} << 20, kMostGridBlocks = std::uint64_t{1} << 22;
// Maximum bytes and number of decompressed blocks that are kept. The number bounds the search for a block.
constexpr std::uint64_t kKept = std::uint64_t{2} << 20, kMostKeptBlocks = 64;

bool is_blank(std::byte byte) {
  return byte == std::byte{' '} || byte == std::byte{'\n'} || byte == std::byte{'\r'} || byte == std::byte{'\t'};
}

template <class T>
double number_of(const std::byte* from, bool big_endian) {
  std::array<std::byte, sizeof(T)> raw{};
  std::memcpy(raw.data(), from, sizeof(T));
  if (big_endian) std::ranges::reverse(raw);
  return static_cast<double>(std::bit_cast<T>(raw));
}

}  // namespace

std::variant<GridArray, std::string> GridArray::open(std::shared_ptr<const net::RandomAccessFile> file,
                                                     const VtkXmlHeader& header, const VtkArray& array,
                                                     std::uint64_t numbers) {
  constexpr std::uint64_t kMostNumbers = std::uint64_t{1} << 48;
  const auto type = vtk_type_of(array.type);
  const std::string name = "the array '" + array.name.substr(0, 80) + "': ";
  if (!type || array.format == "ascii")
    return name + "text cannot be read in parts; use binary or appended data, or raise --memory";
  if (!header.compressor.empty() && header.compressor != "vtkzlibdatacompressor")
    return name + "data compressed with '" + header.compressor.substr(0, 80) +
           "' cannot be read in parts; use vtkZLibDataCompressor or none, or raise --memory";
  if (numbers > kMostNumbers) return name + "it has too many numbers; expected at most 2^48";
  GridArray made;
  made.file_ = std::move(file);
  made.type_ = *type;
  made.numbers_ = numbers;
  made.big_endian_ = header.byte_order == "bigendian";
  made.packed_ = !header.compressor.empty();
  made.word_ = header.header_type == "uint64" ? 8 : 4;
  auto problem = made.find_data(header, array);
  if (!problem) problem = made.read_table();
  const std::uint64_t wanted = numbers * size_of(*type);
  if (!problem && made.bytes_ < wanted)
    problem = "it has " + std::to_string(made.bytes_) + " bytes; expected " + std::to_string(wanted);
  if (problem) return name + *problem;
  return made;
}

// Finds the first byte of the array's header in the file.
std::optional<std::string> GridArray::find_data(const VtkXmlHeader& header, const VtkArray& array) {
  const bool appended = array.format == "appended";
  if (appended && !header.appended) return "the file has no AppendedData";
  base64_ = !appended || header.appended_base64;
  place_ = appended ? *header.appended : array.begin;
  // Skips the blanks before the '_' of appended data, or before the digits.
  std::array<std::byte, 256> head{};
  const std::size_t got = file_->read(place_, head);
  const auto first = std::find_if_not(head.begin(), head.begin() + static_cast<std::ptrdiff_t>(got), is_blank);
  place_ += static_cast<std::uint64_t>(first - head.begin());
  if (!appended) return std::nullopt;
  if (first == head.begin() + static_cast<std::ptrdiff_t>(got) || *first != std::byte{'_'})
    return "AppendedData does not begin with '_'";
  if (array.offset > file_->size()) return "its offset is beyond the end of the file";
  place_ += 1 + array.offset;
  return std::nullopt;
}

// Reads the header of the array: the length of plain data, or the table of compressed blocks.
std::optional<std::string> GridArray::read_table() {
  std::array<std::byte, 24> start{};
  head_ = packed_ ? 3 * word_ : word_;
  if (!read_stored(0, std::span(start).first(static_cast<std::size_t>(head_)))) return "its header is damaged";
  if (!packed_) {
    bytes_ = word_at(start, 0);
    block_ = kPlainBlock;
    const std::uint64_t all = file_->size() - std::min(file_->size(), place_);
    bytes_ = std::min(bytes_, base64_ ? all / 4 * 3 : all);
  } else {
    const std::uint64_t blocks = word_at(start, 0), last = word_at(start, 2);
    block_ = word_at(start, 1);
    if (blocks > kMostGridBlocks || block_ > kMostGridBlock || last > block_ || (blocks > 0 && block_ == 0))
      return "its blocks are too large or too many; expected at most 16 MiB and 2^22, or a larger --memory";
    head_ = (3 + blocks) * word_;
    if (head_ > file_->size()) return "its table of blocks is damaged";
    std::vector<std::byte> table(static_cast<std::size_t>(head_));
    if (!read_stored(0, table)) return "its table of blocks is damaged";
    std::uint64_t end = 0;
    for (std::uint64_t i = 0; i < blocks; ++i) {
      const std::uint64_t length = word_at(table, static_cast<std::size_t>(3 + i));
      if (length > file_->size() || end > file_->size()) return "its table of blocks is damaged";
      ends_.push_back(end += length);
    }
    bytes_ = blocks == 0 ? 0 : (blocks - 1) * block_ + (last == 0 ? block_ : last);
  }
  if (base64_ && ends_with_padding(head_)) data_ = place_ + (head_ + 2) / 3 * 4;
  return std::nullopt;
}

// Reports whether the base64 text of the header ends with padding. If so, the data are a separate base64 text.
bool GridArray::ends_with_padding(std::uint64_t bytes) const {
  std::array<std::byte, 1> last{};
  return bytes % 3 != 0 && file_->read(place_ + (bytes + 2) / 3 * 4 - 1, last) == 1 && last[0] == std::byte{'='};
}

std::uint64_t GridArray::word_at(std::span<const std::byte> bytes, std::size_t index) const {
  std::array<std::byte, 8> raw{};
  std::memcpy(raw.data(), bytes.data() + index * word_, word_);
  if (big_endian_) std::reverse(raw.begin(), raw.begin() + static_cast<std::ptrdiff_t>(word_));
  return std::bit_cast<std::uint64_t>(raw);
}
static_assert(std::endian::native == std::endian::little);

// Reads stored bytes, not decompressed. `offset` counts from the start of the header.
bool GridArray::read_stored(std::uint64_t offset, std::span<std::byte> to) const {
  if (!base64_) return file_->read(place_ + offset, to) == to.size();
  if (data_ != 0 && offset >= head_) return read_base64(data_, offset - head_, to);
  return read_base64(place_, offset, to);
}

// Decodes bytes of the base64 text at `place`, which must have no blanks. `offset` counts decoded bytes.
bool GridArray::read_base64(std::uint64_t place, std::uint64_t offset, std::span<std::byte> to) const {
  const std::uint64_t first = offset / 3, end = (offset + to.size() + 2) / 3;
  std::vector<std::byte> text(static_cast<std::size_t>((end - first) * 4));
  if (file_->read(place + first * 4, text) != text.size()) return false;
  std::uint64_t at = first * 3;  // of the next decoded byte
  std::size_t made = 0;
  for (std::size_t i = 0; i < text.size(); i += 4) {
    std::uint32_t bits = 0;
    std::size_t digits = 0;
    for (; digits < 4 && base64_value(text[i + digits]) >= 0; ++digits)
      bits |= static_cast<std::uint32_t>(base64_value(text[i + digits])) << (18 - 6 * digits);
    for (std::size_t k = 0; k + 1 < digits; ++k, ++at)
      if (at >= offset && made < to.size()) to[made++] = static_cast<std::byte>(bits >> (16 - 8 * k) & 0xff);
    if (digits < 4) break;
  }
  return made == to.size();
}

const GridArray::Block* GridArray::block(std::uint64_t number) {
  ++use_;
  for (Block& one : kept_)
    if (one.number == number) {
      one.used = use_;
      return &one;
    }
  const std::uint64_t begin = number * block_;
  if (begin >= bytes_ || (packed_ && number >= ends_.size())) return nullptr;
  Block made{number, use_, std::vector<std::byte>(static_cast<std::size_t>(std::min(block_, bytes_ - begin)))};
  if (packed_) {
    const std::uint64_t from = number == 0 ? 0 : ends_[static_cast<std::size_t>(number - 1)];
    const std::uint64_t length = ends_[static_cast<std::size_t>(number)] - from;
    // zlib never enlarges a block much.
    if (length > 2 * block_ + 1024) return nullptr;
    std::vector<std::byte> packed(static_cast<std::size_t>(length));
    if (!read_stored(head_ + from, packed) || unpack_into(packed, made.bytes, own_budget())) return nullptr;
  } else if (!read_stored(head_ + begin, made.bytes)) {
    return nullptr;
  }
  const std::size_t most = static_cast<std::size_t>(
      std::clamp<std::uint64_t>(kKept / std::max<std::uint64_t>(1, block_), 2, kMostKeptBlocks));
  if (kept_.size() < most) return &kept_.emplace_back(std::move(made));
  Block& oldest = *std::ranges::min_element(kept_, {}, &Block::used);
  oldest = std::move(made);
  return &oldest;
}

bool GridArray::read_bytes(std::uint64_t offset, std::span<std::byte> to) {
  while (!to.empty()) {
    const Block* const from = block(offset / block_);
    const auto skip = static_cast<std::size_t>(offset % block_);
    if (!from || skip >= from->bytes.size()) return false;
    const std::size_t some = std::min(to.size(), from->bytes.size() - skip);
    std::memcpy(to.data(), from->bytes.data() + skip, some);
    to = to.subspan(some);
    offset += some;
  }
  return true;
}

bool GridArray::read(std::uint64_t first, std::span<double> to) {
  if (first > numbers_ || to.size() > numbers_ - first) return false;
  const std::size_t size = size_of(type_);
  std::array<std::byte, 4096> raw;
  while (!to.empty()) {
    const std::size_t some = std::min(to.size(), raw.size() / size);
    if (!read_bytes(first * size, std::span(raw).first(some * size))) return false;
    with_stored_type(type_, [&](auto kind) {
      for (std::size_t i = 0; i < some; ++i) to[i] = number_of<decltype(kind)>(raw.data() + i * size, big_endian_);
    });
    to = to.subspan(some);
    first += some;
  }
  return true;
}

}  // namespace gs::app
