#include "app/formats/avs/ucd_mesh.h"
#include "app/formats/common/text_cursor.h"

#include <algorithm>
#include <charconv>
#include <limits>
#include <utility>

namespace gs::app {
namespace {

bool integer(std::string_view word, std::int64_t& value) {
  const auto result = std::from_chars(word.data(), word.data() + word.size(), value);
  return !word.empty() && result.ec == std::errc() && result.ptr == word.data() + word.size();
}

/// Map from the file's node or cell numbers to indices. A sorted list instead of a hash table, because hostile numbers
/// could cause collisions.
class Numbers {
 public:
  void add(std::int64_t number) {
    const auto place = static_cast<std::int32_t>(entries_.size());
    sorted_ = sorted_ && (entries_.empty() || entries_.back().first < number);
    entries_.emplace_back(number, place);
  }
  /// Completes the map. Must be called after the last `add`.
  void finish() {
    if (!sorted_) std::sort(entries_.begin(), entries_.end());
    sorted_ = true;
  }
  /// Returns the index of the first entry with this number, or -1.
  [[nodiscard]] std::int32_t find(std::int64_t number) const {
    // In most files, the numbers are consecutive.
    if (!entries_.empty() && number >= entries_.front().first) {
      const auto guess = static_cast<std::uint64_t>(number) - static_cast<std::uint64_t>(entries_.front().first);
      if (guess < entries_.size() && entries_[guess] == std::pair(number, static_cast<std::int32_t>(guess)))
        return entries_[guess].second;
    }
    const auto found = std::lower_bound(entries_.begin(), entries_.end(), std::pair(number, std::int32_t{0}));
    return found != entries_.end() && found->first == number ? found->second : -1;
  }

 private:
  std::vector<std::pair<std::int64_t, std::int32_t>> entries_;
  bool sorted_ = true;
};

class UcdTextReader {
 public:
  UcdTextReader(std::span<const std::byte> bytes, UcdMesh& mesh) : cursor_(bytes), lines_(cursor_.next), mesh_(mesh) {}

  std::optional<UcdProblem> read() {
    (void)(read_counts() && read_nodes() && read_cells() && read_late_counts() &&
           read_values(node_width_, node_count_, mesh_.node_values, mesh_.node_label, true) &&
           read_values(cell_width_, cell_count_, mesh_.cell_values, mesh_.cell_label, false));
    return problem_;
  }

 private:
  bool fail(std::string message) {
    problem_ = UcdProblem{std::move(message), lines_.location(start_).line};
    return false;
  }
  /// Reads the next line that is neither empty nor a comment.
  bool next_line(TextCursor& words) {
    while (cursor_.skip_space()) {
      start_ = cursor_.next;
      const std::string_view line = cursor_.line();
      if (line.starts_with('#')) continue;
      words = TextCursor(line.data(), line.data() + line.size());
      return true;
    }
    start_ = cursor_.next;
    return false;
  }
  bool count(TextCursor& words, std::uint64_t& value) {
    std::int64_t number = 0;
    if (!integer(words.word(), number) || number < 0) return fail("expected a whole number");
    value = static_cast<std::uint64_t>(number);
    return true;
  }

  /// Reads the counts. Usually one line has the numbers of nodes, cells, and values of each. In files with steps, a
  /// line after `step1` has only nodes and cells.
  bool read_counts() {
    TextCursor words(nullptr, nullptr);
    if (!next_line(words)) return fail("expected the numbers of nodes, cells and data");
    TextCursor ahead = cursor_;
    const std::string_view behind = ahead.word();
    const bool alone = count(words, node_count_) && !words.skip_space();
    if (problem_) return false;
    stepped_ = alone && (behind == "data" || behind == "geom" || behind == "data_geom");
    if (stepped_) {
      cursor_ = ahead;
      if (!next_line(words) || !words.word().starts_with("step")) return fail("expected step1");
      if (!next_line(words)) return fail("expected the numbers of nodes and cells");
      return count(words, node_count_) && count(words, cell_count_);
    }
    return count(words, cell_count_) && count(words, node_width_) && count(words, cell_width_);
  }
  bool read_late_counts() {
    if (!stepped_) return true;
    TextCursor words(nullptr, nullptr);
    if (!next_line(words)) return true;  // the file has no data after the geometry
    return count(words, node_width_) && count(words, cell_width_);
  }

  bool read_nodes() {
    for (std::uint64_t i = 0; i < node_count_; ++i) {
      TextCursor words(nullptr, nullptr);
      std::int64_t id = 0;
      glm::vec3 p(0);
      if (!next_line(words))
        return fail("the file ends too early: node " + std::to_string(i + 1) + " of " + std::to_string(node_count_) +
                    " is missing");
      if (i >= static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max())) return fail("too many nodes");
      bool good = integer(words.word(), id);
      for (int k = 0; k < 3; ++k) good = good && words.skip_space() && words.number(p[k]);
      if (!good) return fail("broken node: expected its number and x, y, z");
      node_numbers_.add(id);
      mesh_.nodes.push_back(p);
    }
    node_numbers_.finish();
    return true;
  }

  bool read_cells() {
    for (std::uint64_t i = 0; i < cell_count_; ++i) {
      TextCursor words(nullptr, nullptr);
      if (!next_line(words))
        return fail("the file ends too early: cell " + std::to_string(i + 1) + " of " + std::to_string(cell_count_) +
                    " is missing");
      std::int64_t id = 0, material = 0;
      if (!integer(words.word(), id) || !integer(words.word(), material))
        return fail("broken cell: expected its number, material, type and nodes");
      std::string_view name = words.word();
      if (name.ends_with('2')) name.remove_suffix(1);  // a type with nodes on edges; these follow the corners
      const auto type = std::find(kUcdNames.begin(), kUcdNames.end(), name);
      if (type == kUcdNames.end())
        return fail("unknown type of cell '" + std::string(name.substr(0, 20)) +
                    "'; expected pt, line, tri, quad, tet, pyr, prism or hex");
      UcdCell cell;
      cell.type = static_cast<UcdType>(type - kUcdNames.begin());
      for (std::size_t k = 0; k < kUcdCorners[static_cast<std::size_t>(cell.type)]; ++k) {
        std::int64_t node = 0;
        if (!integer(words.word(), node))
          return fail("broken cell: expected " + std::to_string(kUcdCorners[static_cast<std::size_t>(cell.type)]) +
                      " nodes");
        cell.corners[k] = node_numbers_.find(node);
      }
      mesh_.cells.push_back(cell);
      cell_numbers_.add(id);
    }
    cell_numbers_.finish();
    return true;
  }

  /// Reads a data block: the number of components and their lengths, a label for each component, then a row for each
  /// node or cell.
  bool read_values(std::uint64_t width, std::uint64_t rows, std::vector<float>& values, std::string& label,
                   bool of_nodes) {
    if (width == 0) return true;
    TextCursor words(nullptr, nullptr);
    std::uint64_t components = 0, shown = 0, column = 0, before = 0;
    bool single = false;
    if (!next_line(words)) return fail("the file ends too early: expected data");
    if (!count(words, components)) return false;
    for (std::uint64_t i = 0; i < components; ++i) {
      std::uint64_t length = 0;
      if (!count(words, length)) return false;
      if (length == 1 && !single) {
        single = true;
        shown = i;
        column = before;
      }
      before += length;
    }
    for (std::uint64_t i = 0; i < components; ++i) {
      if (!next_line(words)) return fail("the file ends too early: expected the label of a component");
      const std::string_view line = words.line();
      const std::size_t comma = std::min(line.find(','), line.size());
      if (i == shown) label = ucd_label(line.substr(0, comma), line.substr(std::min(comma + 1, line.size())));
    }
    for (std::uint64_t i = 0; i < rows; ++i) {
      if (!next_line(words)) return fail("the file ends too early: expected a row of data");
      std::int64_t id = 0;
      float value = 0;
      bool good = integer(words.word(), id);
      for (std::uint64_t k = 0; k <= column && good; ++k) good = words.skip_space() && words.number(value);
      if (!good) return fail("broken row of data: expected a number and " + std::to_string(before) + " values");
      place(values, id, value, of_nodes);
    }
    return true;
  }
  /// Stores the value of a row for node or cell number `id`.
  void place(std::vector<float>& values, std::int64_t id, float value, bool of_nodes) {
    if (values.empty())
      values.resize(of_nodes ? mesh_.nodes.size() : mesh_.cells.size(), std::numeric_limits<float>::quiet_NaN());
    const std::int32_t at = (of_nodes ? node_numbers_ : cell_numbers_).find(id);
    if (at >= 0) values[static_cast<std::size_t>(at)] = value;
  }

  TextCursor cursor_;
  LineCounter lines_;
  UcdMesh& mesh_;
  const char* start_ = nullptr;
  std::uint64_t node_count_ = 0, cell_count_ = 0, node_width_ = 0, cell_width_ = 0;
  bool stepped_ = false;
  Numbers node_numbers_, cell_numbers_;
  std::optional<UcdProblem> problem_;
};

}  // namespace

std::optional<UcdProblem> read_ucd_text(std::span<const std::byte> bytes, UcdMesh& mesh) {
  return UcdTextReader(bytes, mesh).read();
}

}  // namespace gs::app
