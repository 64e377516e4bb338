#include "app/formats/common/text_cursor.h"
#include "app/formats/volume/volume_common.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

// Reader of SLC (VolVis). A file has a text header, an icon, then slices of bytes. If the header states this, each
// slice is run-length encoded.

namespace gs::app {
namespace {

constexpr std::string_view kSlcMark = "11111";
constexpr std::size_t kMaxSlcHeader = 4096;

struct SlcHeader {
  std::array<std::uint32_t, 3> sizes{};
  std::array<double, 3> spacing{1, 1, 1};
  double bits = 8, compression = 0;
  std::size_t end = 0;  // byte offset of the first slice
};

// Skips the X after a number. No white space follows it. Returns false if there is no X.
bool pass_mark(TextCursor& cursor) {
  if (!cursor.skip_space() || *cursor.next != 'X') return false;
  ++cursor.next;
  return true;
}

// Reads the header. Returns a message on failure.
std::optional<std::string> read_slc_header(std::span<const std::byte> bytes, SlcHeader& header) {
  TextCursor cursor(bytes.first(std::min(bytes.size(), kMaxSlcHeader)));
  const char* const begin = cursor.next;
  (void)cursor.word();
  const auto read = [&cursor](double& number) { return cursor.skip_space() && cursor.number(number); };
  std::vector<double> sizes(3);
  for (double& size : sizes)
    if (!read(size)) return "expected three sizes";
  const auto dimensions = dimensions_of(sizes);
  if (!dimensions) return "expected three sizes, whole numbers above 0";
  header.sizes = *dimensions;
  if (!read(header.bits)) return "expected the bits of a voxel";
  for (double& one : header.spacing)
    if (!read(one)) return "expected three spacings";
  double unit = 0, origin = 0, modification = 0;
  if (!read(unit) || !read(origin) || !read(modification) || !read(header.compression))
    return "expected unit, origin, modification and compression";
  double width = 0, height = 0;
  constexpr double kLargestIcon = 65536;
  if (!read(width) || !read(height) || !(width >= 0 && width <= kLargestIcon) ||
      !(height >= 0 && height <= kLargestIcon))
    return "expected the size of the icon";
  if (!pass_mark(cursor)) return "expected X before the icon";
  // The red, green and blue planes of the icon start directly after the X.
  const std::size_t icon = static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 3;
  header.end = static_cast<std::size_t>(cursor.next - begin);
  if (icon > bytes.size() - std::min(bytes.size(), header.end)) return "the file ends within its icon";
  header.end += icon;
  return std::nullopt;
}

// Decodes the runs of a slice. Each run begins with a byte; its lower seven bits are the length. If the eighth bit is
// set, that many bytes follow, else one byte that is repeated. Length 0 ends the slice.
bool unpack_slice(std::span<const std::byte> from, std::span<std::byte> to) {
  std::size_t next = 0, done = 0;
  while (next < from.size()) {
    const auto run = std::to_integer<unsigned>(from[next++]);
    const std::size_t length = run & 127;
    if (length == 0) break;
    if (length > to.size() - done) return false;
    if (run & 128) {
      if (length > from.size() - next) return false;
      std::memcpy(to.data() + done, from.data() + next, length);
      next += length;
    } else {
      if (next == from.size()) return false;
      std::fill_n(to.begin() + static_cast<std::ptrdiff_t>(done), length, from[next++]);
    }
    done += length;
  }
  return done == to.size();
}

std::variant<SharedBytes, std::string> unpack_slices(const VolumeFile& file, const SlcHeader& header) {
  const std::span<const std::byte> bytes = file.content.bytes;
  const std::uint64_t slice = std::uint64_t{header.sizes[0]} * header.sizes[1];
  // Two bytes of runs give at most 127 voxels.
  if (slice > std::uint64_t{bytes.size()} * 64 / header.sizes[2])
    return std::string("the file is too short for its sizes");
  const std::uint64_t size = slice * header.sizes[2];
  auto memory = voxel_memory(bytes.size(), size, file.budget);
  if (auto* problem = std::get_if<std::string>(&memory)) return std::move(*problem);
  auto& voxels = std::get<VoxelMemory>(memory);
  std::size_t at = header.end;
  for (std::uint32_t z = 0; z < header.sizes[2]; ++z) {
    const std::string which = "slice " + std::to_string(z + 1) + " of " + std::to_string(header.sizes[2]);
    TextCursor cursor(bytes.subspan(at, std::min<std::size_t>(bytes.size() - at, 32)));
    const char* const begin = cursor.next;
    double length = 0;
    if (!cursor.skip_space() || !cursor.number(length) || !(length >= 0 && length <= 1e15) || !pass_mark(cursor))
      return which + ": expected its length and X";
    at += static_cast<std::size_t>(cursor.next - begin);
    if (static_cast<std::size_t>(length) > bytes.size() - at) return which + ": the file ends too early";
    const auto out =
        std::span(voxels.bytes).subspan(static_cast<std::size_t>(z * slice), static_cast<std::size_t>(slice));
    if (!unpack_slice(bytes.subspan(at, static_cast<std::size_t>(length)), out)) return which + " is damaged";
    at += static_cast<std::size_t>(length);
    if (file.budget->stopped()) return std::string("the time limit for reading was reached");
  }
  return shared_bytes(std::move(voxels));
}

}  // namespace

bool is_slc(std::span<const std::byte> bytes) {
  const std::string_view text = text_of(bytes);
  if (!text.starts_with(kSlcMark)) return false;
  SlcHeader header;
  const auto head = bytes.first(std::min(bytes.size(), kMaxSlcHeader));
  const auto problem = read_slc_header(head, header);
  return !problem || problem->starts_with("the file ends");  // the icon may end after the first bytes
}

VolumeResult open_slc(const VolumeFile& file) {
  if (!text_of(file.content.bytes).starts_with(kSlcMark)) return std::string("the file does not begin with 11111");
  SlcHeader header;
  if (auto problem = read_slc_header(file.content.bytes, header)) return std::move(*problem);
  if (header.bits != 8) return std::string("the voxels do not have 8 bits; expected 8");
  if (header.compression != 0 && header.compression != 1)
    return std::string("an unknown compression; expected 0 (none) or 1 (run lengths)");
  qnv::VolumeLayout layout;
  layout.dimensions = header.sizes;
  for (std::size_t i = 0; i < 3; ++i) layout.axes[i][static_cast<int>(i)] = static_cast<float>(header.spacing[i]);
  StoredVoxels voxels;
  voxels.content = file.content;
  voxels.offset = header.end;
  if (header.compression == 1) {
    auto unpacked = unpack_slices(file, header);
    if (auto* problem = std::get_if<std::string>(&unpacked)) return std::move(*problem);
    voxels.content = std::get<SharedBytes>(std::move(unpacked));
    voxels.offset = 0;
  }
  return make_source(std::move(layout), std::move(voxels));
}

}  // namespace gs::app
