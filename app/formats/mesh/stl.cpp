#include "app/formats/common/content_type.h"
#include "app/formats/common/mesh_asset.h"
#include "app/formats/common/text_cursor.h"
#include "app/formats/mesh/stl_binary.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <string>
#include <vector>

namespace gs::app {
namespace {

/// Index of points by their exact bits. Uses open addressing, so that most look-ups touch only one cache line.
class Welder {
 public:
  explicit Welder(ImportContext& context) : context_(context) {}
  /// Returns the index of a point, and adds the point if it is new. Returns kBadIndex if there are too many points.
  std::int32_t index(glm::vec3 p) {
    // Adding 0 turns -0 into 0, so that both are equal.
    p += glm::vec3(0.0f);
    if (points_.size() * 2 >= table_.size()) grow();
    const std::size_t mask = table_.size() - 1;
    std::size_t slot = hash(p) & mask;
    while (table_[slot].index >= 0) {
      if (same(table_[slot].point, p)) return table_[slot].index;
      slot = (slot + 1) & mask;
    }
    if (points_.size() >= static_cast<std::size_t>(kBadIndex)) return kBadIndex;
    table_[slot] = {p, static_cast<std::int32_t>(points_.size())};
    points_.push(p);
    return table_[slot].index;
  }
  [[nodiscard]] vrml::MFVec3f take() { return points_.take(); }

 private:
  struct Entry {
    glm::vec3 point{0.0f};
    std::int32_t index = -1;
  };

  static bool same(const glm::vec3& a, const glm::vec3& b) { return std::memcmp(&a, &b, sizeof a) == 0; }
  static std::size_t hash(const glm::vec3& p) {
    std::uint64_t h = std::bit_cast<std::uint32_t>(p.x) | std::uint64_t{std::bit_cast<std::uint32_t>(p.y)} << 32;
    h = (h ^ std::bit_cast<std::uint32_t>(p.z) * std::uint64_t{0x9E3779B97F4A7C15}) * 0xBF58476D1CE4E5B9;
    h = (h ^ h >> 29) * 0x94D049BB133111EB;
    return static_cast<std::size_t>(h ^ h >> 32);
  }
  void grow() {
    const std::size_t size = table_.empty() ? 1024 : table_.size() * 2;
    context_.draw(size * sizeof(Entry));
    std::vector<Entry> old(size);
    old.swap(table_);
    const std::size_t mask = table_.size() - 1;
    for (const Entry& entry : old) {
      if (entry.index < 0) continue;
      std::size_t slot = hash(entry.point) & mask;
      while (table_[slot].index >= 0) slot = (slot + 1) & mask;
      table_[slot] = entry;
    }
  }

  ImportContext& context_;
  Appender<glm::vec3> points_{context_};
  std::vector<Entry> table_;
};

void add_shape(MeshBuilder& builder, Geometry geometry, const Look& look, std::string_view name) {
  geometry.color_per_vertex = false;
  if (geometry.coord_index.empty()) {
    builder.warn("no facets in the file");
    return;
  }
  builder.add(std::move(geometry), look, name);
}

void import_binary(std::span<const std::byte> bytes, MeshBuilder& builder) {
  const auto stl = BinaryStl::open(bytes);
  if (!stl) {
    builder.fail(
        "not an STL file: expected a header of 80 bytes and the number of facets, or a text that begins with 'solid'");
    return;
  }
  const std::size_t count = stl->size();
  if (stl->announced() > count)
    builder.fail("the file ends too early: expected " + std::to_string(stl->announced()) + " facets, found " +
                 std::to_string(count));

  Welder welder(builder);
  Appender<std::int32_t> corners(builder);
  for (std::size_t i = 0; i < count; ++i) {
    for (const glm::vec3& p : stl->corners(i)) corners.push(welder.index(p));
    corners.push(kFaceEnd);
  }

  Geometry geometry;
  Look look;
  if (stl->object_color()) look.diffuse = *stl->object_color();
  if (stl->has_colors(count)) {
    Appender<vrml::Color> colors(builder);
    for (std::size_t i = 0; i < count; ++i) colors.push(stl->color(i));
    geometry.colors = colors.take();
  }
  geometry.positions = welder.take();
  geometry.coord_index = corners.take();
  add_shape(builder, std::move(geometry), look, {});
}

/// Keyword of a text STL, in upper or lower case.
enum class Word : std::uint8_t { vertex, endloop, facet, solid, endsolid, filler, other };

Word word_of(std::string_view text) {
  std::array<char, 10> lower{};
  if (text.size() > lower.size()) return Word::other;
  std::transform(text.begin(), text.end(), lower.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  const std::string_view word(lower.data(), text.size());
  if (word == "vertex") return Word::vertex;
  if (word == "endloop") return Word::endloop;
  if (word == "facet") return Word::facet;
  if (word == "solid") return Word::solid;
  if (word == "endsolid") return Word::endsolid;
  return word == "outer" || word == "loop" || word == "endfacet" ? Word::filler : Word::other;
}

class TextImporter {
 public:
  TextImporter(std::span<const std::byte> bytes, MeshBuilder& builder)
      : cursor_(bytes), lines_(cursor_.next), builder_(builder) {}

  void run() {
    while (cursor_.skip_space()) {
      const char* start = cursor_.next;
      switch (word_of(cursor_.word())) {
        case Word::vertex:
          vertex(start);
          break;
        case Word::endloop:
          end_loop(start);
          break;
        case Word::facet:
          facet();
          break;
        case Word::solid:
          solid();
          break;
        case Word::endsolid:
          (void)cursor_.line();
          ended_ = true;
          break;
        case Word::filler:
          break;
        case Word::other:
          if (!complained_)
            builder_.warn("unknown word; expected solid, facet, outer loop, vertex, endloop, endfacet or endsolid",
                          lines_.location(start));
          complained_ = true;
      }
    }
    drop_loop();
    if (!ended_) builder_.fail("the file ends too early: expected endsolid", lines_.location(cursor_.end));
    Geometry geometry;
    geometry.positions = welder_.take();
    geometry.coord_index = corners_.take();
    geometry.convex = convex_;
    add_shape(builder_, std::move(geometry), {}, name_);
  }

 private:
  void solid() {
    const std::string_view name = trimmed(cursor_.line());
    if (name_.empty()) name_ = name;
    ended_ = false;
  }

  /// Begins a facet. Ignores the stored normal, because the corners give an equal or better one.
  void facet() {
    drop_loop();
    cursor_.skip_space();
    const char* start = cursor_.next;
    if (word_of(cursor_.word()) != Word::other) cursor_.next = start;
    float ignored = 0;
    for (int i = 0; i < 3 && cursor_.skip_space(); ++i)
      if (!cursor_.number(ignored)) {
        // Degenerate facets may have the normal "nan" or "-1.#IND".
        const char* word = cursor_.next;
        if (word_of(cursor_.word()) != Word::other) cursor_.next = word;
      }
  }

  void vertex(const char* start) {
    glm::vec3 p(0.0f);
    for (int i = 0; i < 3; ++i)
      if (!cursor_.skip_space() || !cursor_.number(p[i])) {
        builder_.fail("broken vertex; expected three numbers", lines_.location(start));
        (void)cursor_.line();
        broken_ = true;
        return;
      }
    corners_.push(welder_.index(p));
    ++loop_;
  }

  void end_loop(const char* start) {
    if (loop_ < 3 && !broken_) {
      builder_.fail("a facet of " + std::to_string(loop_) + " corners; expected three", lines_.location(start));
      broken_ = true;
    }
    if (broken_) {
      drop_loop();
      return;
    }
    convex_ = convex_ && loop_ == 3;
    corners_.push(kFaceEnd);
    loop_ = 0;
  }

  /// Drops the corners of the current, incomplete facet.
  void drop_loop() {
    if (loop_ > 0) corners_.drop(loop_);
    loop_ = 0;
    broken_ = false;
  }

  TextCursor cursor_;
  LineCounter lines_;
  MeshBuilder& builder_;
  Welder welder_{builder_};
  Appender<std::int32_t> corners_{builder_};
  std::string name_;
  std::size_t loop_ = 0;  // number of corners of the current facet
  bool broken_ = false, convex_ = true, ended_ = false, complained_ = false;
};

/// Imports the triangles of a binary or text STL file as one part. Merges equal corners; uses creaseAngle 0 (flat
/// shading, as CAD parts need) instead of normals. Attribute bytes with colours become face colours: the VisCAM and
/// SolidView form (bit 15 set on every facet), or Materialise Magics (COLOR= in the header). Binary files are detected
/// by size, because their header may begin with "solid". A truncated file gives an error and its complete facets.
void import_stl(std::span<const std::byte> bytes, MeshBuilder& builder) {
  if (is_text_stl(bytes))
    TextImporter(bytes, builder).run();
  else
    import_binary(bytes, builder);
}

}  // namespace

bool is_text_stl(std::span<const std::byte> bytes) {
  if (bytes.size() >= BinaryStl::kDataStart) {
    std::uint64_t announced = 0;
    for (std::size_t i = 4; i-- > 0;)
      announced = announced << 8 | std::to_integer<std::uint64_t>(bytes[BinaryStl::kHeaderBytes + i]);
    if (bytes.size() == BinaryStl::kDataStart + announced * BinaryStl::kFacetBytes) return false;
  }
  TextCursor cursor(bytes);
  if (word_of(cursor.word()) != Word::solid) return false;
  // The file may be a binary file with missing or trailing bytes. Such a file contains zero bytes.
  constexpr std::size_t kLooked = 1024;
  const auto looked = bytes.first(std::min(bytes.size(), kLooked));
  return std::none_of(looked.begin(), looked.end(), [](std::byte b) { return b == std::byte{0}; });
}

extern constinit const ContentType kStlFormat =
    mesh_type("STL", "model/stl", ".stl ", nullptr, read_mesh<import_stl>, {UpRule::z, true});

}  // namespace gs::app
