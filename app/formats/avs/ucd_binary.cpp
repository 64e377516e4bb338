#include "app/formats/avs/ucd_mesh.h"
#include "app/formats/ply/ply_source.h"

#include <algorithm>

namespace gs::app {
namespace {

constexpr std::size_t kUcdHeaderBytes = 25, kCellBytes = 16, kLabelBytes = 2048;

template <bool big>
class UcdBinaryReader {
 public:
  explicit UcdBinaryReader(std::span<const std::byte> bytes) : bytes_(bytes) {
    if (bytes.size() < kUcdHeaderBytes) return;
    for (std::size_t i = 0; i < counts_.size(); ++i) counts_[i] = word(1 + 4 * i);
  }

  /// Returns the size of nodes, cells and corner list in bytes. The counts have 32 bits, so the sum cannot overflow.
  [[nodiscard]] std::uint64_t mesh_bytes() const {
    return kUcdHeaderBytes + kCellBytes * cells() + 4 * corners() + 12 * nodes();
  }
  [[nodiscard]] std::uint64_t block_bytes(std::uint64_t values, std::uint64_t rows) const {
    return values == 0 ? 0 : kLabelBytes + 4 + values * (16 + 4 * rows);
  }
  [[nodiscard]] bool holds_mesh() const { return bytes_.size() >= kUcdHeaderBytes && mesh_bytes() <= bytes_.size(); }
  /// Returns true if the file has exactly the size that the counts require. Model data are not supported.
  [[nodiscard]] bool is_exact() const {
    return holds_mesh() && counts_[2] < (1u << 24) && counts_[3] < (1u << 24) &&
           mesh_bytes() + block_bytes(counts_[2], nodes()) + block_bytes(counts_[3], cells()) == bytes_.size();
  }

  [[nodiscard]] std::optional<UcdProblem> read(UcdMesh& mesh) const {
    const std::size_t list = kUcdHeaderBytes + kCellBytes * cells(), coordinates = list + 4 * corners();
    mesh.nodes.resize(nodes());
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t i = 0; i < nodes(); ++i)
        mesh.nodes[i][static_cast<int>(k)] = number(coordinates + 4 * (k * nodes() + i));
    std::uint64_t next = 0;
    for (std::size_t i = 0; i < cells(); ++i) {
      const std::size_t at = kUcdHeaderBytes + kCellBytes * i;
      const std::uint32_t length = word(at + 8), type = word(at + 12);
      if (type >= kUcdCorners.size())
        return UcdProblem{"cell " + std::to_string(i + 1) + " is of unknown type " + std::to_string(type) +
                          "; expected 0 to 7"};
      if (length > corners() - next || length < kUcdCorners[type])
        return UcdProblem{"cell " + std::to_string(i + 1) + " has " + std::to_string(length) + " nodes; expected " +
                          std::to_string(kUcdCorners[type]) + " or more, within the list"};
      UcdCell cell;
      cell.type = static_cast<UcdType>(type);
      for (std::size_t k = 0; k < kUcdCorners[type]; ++k) {
        const std::uint32_t node = word(list + 4 * (next + k));
        cell.corners[k] = node >= 1 && node <= nodes() ? static_cast<std::int32_t>(node - 1) : -1;
      }
      next += length;
      mesh.cells.push_back(cell);
    }
    const std::uint64_t node_data = mesh_bytes(), cell_data = node_data + block_bytes(counts_[2], nodes());
    mesh.node_values = values(node_data, counts_[2], nodes(), mesh.node_label);
    mesh.cell_values = values(cell_data, counts_[3], cells(), mesh.cell_label);
    return std::nullopt;
  }

 private:
  [[nodiscard]] std::size_t nodes() const { return counts_[0]; }
  [[nodiscard]] std::size_t cells() const { return counts_[1]; }
  [[nodiscard]] std::size_t corners() const { return counts_[5]; }
  [[nodiscard]] std::uint32_t word(std::size_t at) const { return load<std::uint32_t, big>(bytes_.data() + at); }
  [[nodiscard]] float number(std::size_t at) const { return load<float, big>(bytes_.data() + at); }

  /// Returns the values of a data block. Takes the first component with one number per row. The layout is: labels and
  /// units, number of components, their lengths, minima and maxima, then all values component by component.
  [[nodiscard]] std::vector<float> values(std::uint64_t start, std::uint64_t width, std::uint64_t rows,
                                          std::string& label) const {
    if (width == 0 || width > (1u << 24) || start + block_bytes(width, rows) > bytes_.size()) return {};
    const std::uint32_t components = word(start + kLabelBytes);
    std::uint64_t column = 0, length = 0, shown = 0;
    for (std::uint64_t i = 0; i < std::min<std::uint64_t>(components, width); ++i) {
      shown = i;
      length = word(start + kLabelBytes + 4 + 4 * i);
      if (length == 1 || length > width - column) break;
      column += length;
    }
    const bool single = length == 1 && column < width;
    if (!single) {
      // No component has one number. Use the first number of the first vector.
      column = shown = 0;
      length = word(start + kLabelBytes + 4);
      if (length == 0 || length > width) length = 1;
    }
    label = ucd_label(part_of(start, shown), part_of(start + kLabelBytes / 2, shown));
    const std::uint64_t data = start + kLabelBytes + 4 + 12 * width + 4 * column * rows;
    std::vector<float> result(rows);
    for (std::uint64_t i = 0; i < rows; ++i) result[i] = number(data + 4 * i * length);
    return result;
  }

  /// Returns item `part` of a list of names or units. Dots separate the items, a zero byte ends the list.
  [[nodiscard]] std::string_view part_of(std::uint64_t start, std::uint64_t part) const {
    std::string_view text(reinterpret_cast<const char*>(bytes_.data() + start), kLabelBytes / 2);
    text = text.substr(0, text.find('\0'));
    for (; part > 0 && !text.empty(); --part) text.remove_prefix(std::min(text.find('.'), text.size() - 1) + 1);
    return text.substr(0, text.find('.'));
  }

  std::span<const std::byte> bytes_;
  std::array<std::uint32_t, 6> counts_{};  // nodes; cells; values per node, per cell, of the model; corners
};

}  // namespace

std::optional<UcdProblem> read_ucd_binary(std::span<const std::byte> bytes, UcdMesh& mesh) {
  // The file does not state its byte order. Take the order with plausible counts.
  const UcdBinaryReader<false> little(bytes);
  const UcdBinaryReader<true> big(bytes);
  if (little.is_exact()) return little.read(mesh);
  if (big.is_exact()) return big.read(mesh);
  if (little.holds_mesh() && (!big.holds_mesh() || little.mesh_bytes() >= big.mesh_bytes())) return little.read(mesh);
  if (big.holds_mesh()) return big.read(mesh);
  return UcdProblem{"the file ends too early: its nodes and cells need more bytes than the " +
                    std::to_string(bytes.size()) + " of the file"};
}

}  // namespace gs::app
