#include "app/formats/common/content_type.h"
#include "app/formats/common/mesh_asset.h"
#include "app/formats/common/text_cursor.h"
#include "base/text.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

// Reference of the format: http://www.geomview.org/docs/html/OFF.html

namespace gs::app {
namespace {

constexpr double kMaxCount = 2e9;

/// Data that each corner has. The letters before OFF in the first word select it.
struct OffKind {
  bool texture = false, colors = false, normals = false, four = false, any_dimension = false;
};

std::optional<OffKind> off_kind_of(std::string_view word) {
  OffKind kind;
  const auto take = [&word](std::string_view letters) {
    const bool there = word.starts_with(letters);
    if (there) word.remove_prefix(letters.size());
    return there;
  };
  kind.texture = take("ST");
  kind.colors = take("C");
  kind.normals = take("N");
  kind.four = take("4");
  kind.any_dimension = take("n");
  return word == "OFF" ? std::optional(kind) : std::nullopt;
}

class OffImporter {
 public:
  OffImporter(std::span<const std::byte> bytes, MeshBuilder& builder)
      : cursor_(bytes), lines_(cursor_.next), builder_(builder) {}

  void run() {
    const std::optional<OffKind> kind = off_kind_of(cursor_.word());
    if (!kind) return builder_.fail("not an OFF file: expected OFF, COFF, NOFF or STOFF at the start", {1, 1});
    kind_ = *kind;
    if (kind_.four || kind_.any_dimension)
      return builder_.fail("the points are not three-dimensional (4OFF, nOFF); expected OFF", {1, 1});
    to_number();
    if (text_left().starts_with("BINARY")) return builder_.fail("a binary OFF file; expected text", place());
    std::array<std::int64_t, 3> counts{};
    for (std::int64_t& count : counts)
      if (!count_of(count)) return builder_.fail("expected the numbers of points, faces and edges", place());
    const bool whole =
        read_points(static_cast<std::size_t>(counts[0])) && read_faces(static_cast<std::size_t>(counts[1]));
    if (!whole) builder_.fail(problem_, place());
    build();
  }

 private:
  [[nodiscard]] SourceLocation place() { return lines_.location(cursor_.next); }
  [[nodiscard]] std::string_view text_left() const {
    return {cursor_.next, static_cast<std::size_t>(cursor_.end - cursor_.next)};
  }
  /// Skips white space and comments. Returns false at the end of the file.
  bool to_number() {
    while (cursor_.skip_space()) {
      if (*cursor_.next != '#') return true;
      (void)cursor_.line();
    }
    return false;
  }
  template <class Number>
  bool number(Number& value) {
    return to_number() && cursor_.number(value);
  }
  /// Reads a non-negative integer.
  bool count_of(std::int64_t& value) {
    double read = 0;
    if (!number(read) || !(read >= 0 && read <= kMaxCount)) return false;
    value = static_cast<std::int64_t>(read);
    return static_cast<double>(value) == read;
  }
  /// Reads the numbers up to the end of the line, at most numbers.size(). Returns their number. Sets `whole` to true if
  /// all are integers.
  std::size_t rest_of_line(std::array<float, 6>& numbers, bool& whole) {
    const std::string_view line = cursor_.line();
    TextCursor rest(line.data(), line.data() + line.size());
    std::size_t count = 0;
    whole = true;
    while (count < numbers.size() && rest.skip_space() && *rest.next != '#') {
      const char* first = rest.next;
      if (!rest.number(numbers[count])) break;
      for (const char* c = first; c < rest.next; ++c) whole = whole && *c != '.' && *c != 'e' && *c != 'E';
      ++count;
    }
    return count;
  }
  static vrml::Color color_of(const float* numbers, bool whole) {
    const float most = whole ? 255.0f : 1.0f;
    return {numbers[0] / most, numbers[1] / most, numbers[2] / most};
  }

  bool read_points(std::size_t count) {
    const bool more = kind_.colors || kind_.texture;
    for (std::size_t i = 0; i < count; ++i) {
      glm::vec3 point(0), normal(0);
      bool good = true;
      for (int k = 0; k < 3; ++k) good = good && number(point[k]);
      for (int k = 0; kind_.normals && k < 3; ++k) good = good && number(normal[k]);
      if (!good) return stop("a point", i, count);
      points_.push(point);
      if (kind_.normals) normals_.push(normal);
      if (more) read_point_look();
    }
    return true;
  }
  void read_point_look() {
    std::array<float, 6> numbers{};
    bool whole = true;
    const std::size_t found = rest_of_line(numbers, whole), texture = kind_.texture ? 2 : 0;
    // Colours are integers only if all numbers of the line are integers. On lines with texture coordinates, colours are
    // decimals.
    if (kind_.colors)
      colors_.push(found >= 3 + texture ? color_of(numbers.data(), whole && texture == 0) : vrml::Color{1, 1, 1});
    if (texture == 0) return;
    const bool there = found >= texture;
    texture_.push(there ? glm::vec2(numbers[found - 2], numbers[found - 1]) : glm::vec2(0));
  }

  bool read_faces(std::size_t count) {
    bool colored = false;
    for (std::size_t i = 0; i < count; ++i) {
      std::int64_t corners = 0;
      if (!count_of(corners)) return stop("a face", i, count);
      for (std::int64_t k = 0; k < corners; ++k) {
        double index = 0;
        if (!number(index)) {
          indices_.drop(static_cast<std::size_t>(k));
          return stop("a face", i, count);
        }
        indices_.push(index >= 0 && index < kBadIndex ? static_cast<std::int32_t>(index) : kBadIndex);
      }
      std::array<float, 6> numbers{};
      bool whole = true;
      const std::size_t found = rest_of_line(numbers, whole);
      // With less than three corners, this is a point or a line.
      if (corners < 3) {
        indices_.drop(static_cast<std::size_t>(corners));
        ++omitted_faces_;
        continue;
      }
      indices_.push(kFaceEnd);
      convex_ = convex_ && corners == 3;
      colored = colored || found >= 3;
      face_colors_.push(found >= 3 ? color_of(numbers.data(), whole) : vrml::Color{0.8f, 0.8f, 0.8f});
    }
    if (!colored) face_colors_.drop(face_colors_.size());
    return true;
  }
  bool stop(const std::string& what, std::size_t i, std::size_t count) {
    problem_ = "the file ends early or has other content; expected " + what + " (" + std::to_string(i + 1) + " of " +
               std::to_string(count) + ")";
    return false;
  }

  void build() {
    if (omitted_faces_ > 0) builder_.note(std::to_string(omitted_faces_) + " faces of fewer than three corners are left out");
    if (indices_.empty()) return builder_.warn("no faces in the file");
    Geometry geometry;
    geometry.positions = points_.take();
    geometry.coord_index = indices_.take();
    geometry.convex = convex_;
    geometry.normals = normals_.take();
    geometry.texture_coordinates = texture_.take();
    geometry.colors = colors_.take();
    if (geometry.colors.empty()) {
      geometry.colors = face_colors_.take();
      geometry.color_per_vertex = geometry.colors.empty();
    }
    builder_.add(std::move(geometry));
  }

  TextCursor cursor_;
  LineCounter lines_;
  MeshBuilder& builder_;
  OffKind kind_;
  std::string problem_;
  Appender<glm::vec3> points_{builder_}, normals_{builder_};
  Appender<glm::vec2> texture_{builder_};
  Appender<vrml::Color> colors_{builder_}, face_colors_{builder_};
  Appender<std::int32_t> indices_{builder_};
  std::size_t omitted_faces_ = 0;
  bool convex_ = true;
};

/// Imports an OFF file (Geomview, Object File Format) as one part: text only, with colours of points or faces, normals
/// and texture coordinates. Skips faces of fewer than three corners. A truncated file gives an error and its complete
/// faces.
void import_off(std::span<const std::byte> bytes, MeshBuilder& builder) { OffImporter(bytes, builder).run(); }

bool is_off(std::span<const std::byte> bytes) {
  constexpr std::size_t kLongest = 8;
  TextCursor cursor(bytes.first(std::min(bytes.size(), kLongest)));
  return off_kind_of(cursor.word()).has_value();
}

}  // namespace

extern constinit const ContentType kOffFormat = {.name = "OFF",
                                                 .mime = "model/x-off",
                                                 .extensions = ".off ",
                                                 .sniff = is_off,
                                                 .content = ContentClass::mesh,
                                                 .read = read_mesh<import_off>};

}  // namespace gs::app
