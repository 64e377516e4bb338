#include "app/formats/common/content_type.h"
#include "app/formats/common/geometry_check.h"
#include "app/formats/common/mesh_asset.h"
#include "app/formats/common/text_cursor.h"
#include "app/formats/mesh/obj_material.h"

#include <algorithm>
#include <array>
#include <map>
#include <numbers>
#include <string_view>
#include <tuple>
#include <unordered_map>
#include <utility>

namespace gs::app {
namespace {

// Maximum number of Shapes, because each Shape costs nodes. Some files consist only of groups.
constexpr std::size_t kMaxParts = 100'000;
// Crease angle for files without normals. Keeps the edges of a cube sharp and a scan smooth.
constexpr float kObjCreaseAngle = std::numbers::pi_v<float> / 3;
constexpr std::size_t kMaxLibraries = 1000;
constexpr std::int32_t kNone = -2;

/// Key of a Shape. A Shape has all faces with the same attributes, group, material and smoothing.
struct PartKey {
  Geometry::Kind kind = Geometry::Kind::faces;
  std::uint32_t group = 0, material = 0;
  bool textured = false, has_normals = false, smooth_known = false, smooth = false;
  friend auto operator<=>(const PartKey&, const PartKey&) = default;
};

struct Part {
  explicit Part(ImportContext& context) : corners(context), texture(context), normals(context) {}
  Appender<std::int32_t> corners, texture, normals;
  bool convex = true;
};

/// Map from names to consecutive numbers and back.
class Names {
 public:
  Names() { number({}); }
  std::uint32_t number(std::string_view name) {
    const auto [entry, added] = numbers_.try_emplace(std::string(name), static_cast<std::uint32_t>(names_.size()));
    if (added) names_.push_back(&entry->first);
    return entry->second;
  }
  [[nodiscard]] const std::string& name(std::uint32_t number) const { return *names_[number]; }

 private:
  std::unordered_map<std::string, std::uint32_t> numbers_;
  std::vector<const std::string*> names_;
};

struct ObjCorner {
  std::int32_t position = kNone, texture = kNone, normal = kNone;
};

class ObjImporter {
 public:
  ObjImporter(std::span<const std::byte> bytes, MeshBuilder& builder, const ReadFile& read_file)
      : cursor_(bytes), lines_(cursor_.next), builder_(builder), read_file_(read_file) {}

  void run() {
    while (cursor_.skip_space()) statement();
    build();
  }

 private:
  // --- Reading of text -----------------------------------------------------------------------------

  /// Skips blanks, and line ends after a backslash. Returns false at the end of the statement.
  bool skip_blanks() {
    while (cursor_.next < cursor_.end) {
      const char c = *cursor_.next;
      if (c == ' ' || c == '\t' || c == '\v' || c == '\f') {
        ++cursor_.next;
      } else if (c == '\\' && line_continues()) {
        cursor_.next += cursor_.next[1] == '\r' ? 3 : 2;
      } else {
        return c != '\n' && c != '\r' && c != '#';
      }
    }
    return false;
  }
  [[nodiscard]] bool line_continues() const {
    const auto left = cursor_.end - cursor_.next;
    return left >= 2 && (cursor_.next[1] == '\n' || (left >= 3 && cursor_.next[1] == '\r' && cursor_.next[2] == '\n'));
  }
  std::string_view word() {
    if (!skip_blanks()) return {};
    const char* first = cursor_.next;
    while (cursor_.next < cursor_.end && !TextCursor::is_space(*cursor_.next)) ++cursor_.next;
    return {first, static_cast<std::size_t>(cursor_.next - first)};
  }
  /// Returns the rest of the line, trimmed. For names with blanks.
  std::string_view rest() { return trimmed(cursor_.line()); }

  void end_statement() {
    while (skip_blanks()) (void)word();
    if (cursor_.next < cursor_.end && *cursor_.next == '#') (void)cursor_.line();
  }
  void broken(const char* at, std::string message) { builder_.fail(std::move(message), lines_.location(at)); }

  // --- Statements -----------------------------------------------------------------------------------

  void statement() {
    const char* start = cursor_.next;
    // The most frequent statements are detected by their first letters, which is faster than a search.
    const bool second = cursor_.end - start >= 2;
    const bool blank_second = second && (start[1] == ' ' || start[1] == '\t');
    if (*start == 'v' && second) {
      if (blank_second) return position(start);
      const bool blank_third = cursor_.end - start >= 3 && (start[2] == ' ' || start[2] == '\t');
      if (start[1] == 'n' && blank_third) return normal(start);
      if (start[1] == 't' && blank_third) return texture_coordinate(start);
    }
    if (*start == 'f' && blank_second) return element(start, Geometry::Kind::faces);
    if (*start == '#') return (void)cursor_.line();
    other(start);
  }

  void other(const char* start) {
    const std::string_view keyword = word();
    if (keyword == "l") return element(start, Geometry::Kind::lines);
    if (keyword == "p") return element(start, Geometry::Kind::points);
    if (keyword == "fo") return element(start, Geometry::Kind::faces);  // name of "f" before 1990
    if (keyword == "g" || keyword == "o") {
      key_.group = names_.number(rest());
      current_ = nullptr;
    } else if (keyword == "usemtl") {
      key_.material = materials_used_.number(rest());
      current_ = nullptr;
    } else if (keyword == "s") {
      const std::string_view value = word();
      key_.smooth_known = true;
      key_.smooth = value != "off" && value != "0";
      current_ = nullptr;
      end_statement();
    } else if (keyword == "mtllib") {
      library(rest(), start);
    } else {
      if (!known(keyword) && !complained_) {
        builder_.warn("unknown statement '" + std::string(keyword.substr(0, 40)) + "' is skipped; reported once",
                      lines_.location(start));
        complained_ = true;
      }
      end_statement();
    }
  }

  /// Returns true if the OBJ format defines the statement and this importer ignores it.
  static bool known(std::string_view keyword) {
    constexpr std::string_view kKnown[] = {
        "vp",         "deg",       "bmat",  "step",  "cstype", "curv", "curv2",  "surf",     "parm",     "trim",
        "hole",       "scrv",      "sp",    "end",   "con",    "mg",   "bevel",  "c_interp", "d_interp", "lod",
        "shadow_obj", "trace_obj", "ctech", "stech", "call",   "csh",  "usemap", "maplib"};
    return keyword.empty() || std::find(std::begin(kKnown), std::end(kKnown), keyword) != std::end(kKnown);
  }

  /// Reads up to `most` numbers. Returns the number of numbers read.
  int numbers(float* to, int most) {
    int count = 0;
    while (count < most && skip_blanks() && cursor_.number(to[count])) ++count;
    return count;
  }

  void position(const char* start) {
    cursor_.next = start + 1;
    std::array<float, 7> v{};
    const int count = numbers(v.data(), 7);
    if (count < 3) broken(start, "broken vertex; expected: v X Y Z");
    // An invalid vertex is stored too, because later indices count it.
    positions_.push({v[0], v[1], v[2]});
    if (count >= 6) {
      colors_.fill(positions_.size() - 1, {1, 1, 1});
      const std::size_t first = count == 7 ? 4 : 3;  // the 4th of 7 numbers is the weight
      colors_.push({v[first], v[first + 1], v[first + 2]});
    }
    end_statement();
  }

  void normal(const char* start) {
    cursor_.next = start + 2;
    glm::vec3 n(0.0f);
    if (numbers(&n.x, 3) < 3) broken(start, "broken normal; expected: vn X Y Z");
    normals_.push(n);
    end_statement();
  }

  void texture_coordinate(const char* start) {
    cursor_.next = start + 2;
    glm::vec2 t(0.0f);
    if (numbers(&t.x, 2) < 1) broken(start, "broken texture coordinate; expected: vt U V");
    texture_coordinates_.push(t);
    end_statement();
  }

  /// Reads one index of the form v/t/n. Indices count from 1; negative ones count backwards from the last element. An
  /// invalid index becomes kBadIndex. Returns false if there is no digit.
  bool index(std::size_t count, std::int32_t& value) {
    const char* digit = cursor_.next;
    const bool negative = digit < cursor_.end && *digit == '-';
    if (negative) ++digit;
    const char* first = digit;
    std::int64_t number = 0;
    for (; digit < cursor_.end && *digit >= '0' && *digit <= '9'; ++digit)
      number = std::min<std::int64_t>(number * 10 + (*digit - '0'), kBadIndex);
    if (digit == first) return false;
    cursor_.next = digit;
    if (negative) number = -number;
    if (number < 0) number += static_cast<std::int64_t>(count) + 1;
    value = number >= 1 && number < kBadIndex ? static_cast<std::int32_t>(number - 1) : kBadIndex;
    return true;
  }

  bool corner(ObjCorner& c) {
    if (!index(positions_.size(), c.position)) return false;
    const auto slash = [this] {
      if (cursor_.next == cursor_.end || *cursor_.next != '/') return false;
      ++cursor_.next;
      return true;
    };
    const auto number_follows = [this] {
      return cursor_.next < cursor_.end && *cursor_.next != '/' && !TextCursor::is_space(*cursor_.next);
    };
    if (slash()) {
      if (number_follows() && !index(texture_coordinates_.size(), c.texture)) return false;
      if (slash() && number_follows() && !index(normals_.size(), c.normal)) return false;
    }
    return cursor_.next == cursor_.end || TextCursor::is_space(*cursor_.next) || *cursor_.next == '\\';
  }

  void element(const char* start, Geometry::Kind kind) {
    if (kind == Geometry::Kind::faces && *cursor_.next == 'f') ++cursor_.next;
    corners_.clear();
    bool good = true, textured = true, has_normals = true;
    while (good && skip_blanks()) {
      ObjCorner c;
      good = corner(c);
      textured = textured && c.texture != kNone;
      has_normals = has_normals && c.normal != kNone;
      corners_.push_back(c);
    }
    const std::size_t least = kind == Geometry::Kind::faces ? 3 : kind == Geometry::Kind::lines ? 2 : 1;
    if (good && corners_.size() >= least)
      add(kind, textured && kind == Geometry::Kind::faces, has_normals && kind == Geometry::Kind::faces);
    else
      broken(start, "broken element; expected at least " + std::to_string(least) + " of V, V/T, V//N or V/T/N");
    end_statement();
  }

  void add(Geometry::Kind kind, bool textured, bool has_normals) {
    Part& to = part(kind, textured, has_normals);
    for (const ObjCorner& c : corners_) {
      to.corners.push(c.position);
      if (textured) to.texture.push(c.texture);
      if (has_normals) to.normals.push(c.normal);
    }
    if (kind == Geometry::Kind::points) return;
    to.corners.push(kFaceEnd);
    if (textured) to.texture.push(kFaceEnd);
    if (has_normals) to.normals.push(kFaceEnd);
    to.convex = to.convex && corners_.size() <= 3;
  }

  Part& part(Geometry::Kind kind, bool textured, bool has_normals) {
    if (current_ && key_.kind == kind && key_.textured == textured && key_.has_normals == has_normals) return *current_;
    key_.kind = kind;
    key_.textured = textured;
    key_.has_normals = has_normals;
    PartKey key = key_;
    if (parts_.size() >= kMaxParts && !parts_.contains(key)) {
      if (!full_) builder_.warn("more than " + std::to_string(kMaxParts) + " groups; merged the rest");
      full_ = true;
      key.group = key.material = 0;
    }
    const auto [entry, added] = parts_.try_emplace(key, builder_);
    if (added) order_.push_back(&*entry);
    current_ = &entry->second;
    return *current_;
  }

  void library(std::string_view name, const char* start) {
    if (!read_file_) {
      builder_.note("material library " + std::string(name) + " is not read", lines_.location(start));
      return;
    }
    if (libraries_.size() >= kMaxLibraries || std::find(libraries_.begin(), libraries_.end(), name) != libraries_.end())
      return;
    libraries_.emplace_back(name);
    const BytesResult found = read_file_(libraries_.back());
    if (const auto* problem = std::get_if<std::string>(&found))
      builder_.warn("material library " + std::string(name) + " cannot be read: " + *problem, lines_.location(start));
    else
      read_obj_materials(std::get<SharedBytes>(found).bytes, libraries_.back(), materials_, builder_);
  }

  // --- Building of the scene -----------------------------------------------------------------------

  void build() {
    all_positions_ = positions_.take();
    all_normals_ = normals_.take();
    all_texture_coordinates_ = texture_coordinates_.take();
    if (!colors_.empty()) colors_.fill(all_positions_.size(), {1, 1, 1});
    all_colors_ = colors_.take();
    for (auto* entry : order_) build(entry->first, entry->second);
    if (!order_.empty()) return;
    if (all_positions_.empty()) {
      builder_.warn("no vertices in the file");
      return;
    }
    // The file has only points.
    Geometry points;
    points.kind = Geometry::Kind::points;
    points.positions = std::move(all_positions_);
    points.colors = std::move(all_colors_);
    builder_.add(std::move(points), glowing({}));
  }

  void build(const PartKey& key, Part& part) {
    Geometry geometry;
    geometry.kind = key.kind;
    geometry.coord_index = part.corners.take();
    geometry.texture_index = part.texture.take();
    geometry.normal_index = part.normals.take();
    geometry.convex = part.convex;
    if (key.smooth_known)
      geometry.crease_angle = key.smooth ? std::numbers::pi_v<float> : 0;
    else
      geometry.crease_angle = kObjCreaseAngle;
    if (key.kind == Geometry::Kind::points) {
      take_points(geometry);
    } else if (order_.size() == 1) {
      geometry.positions = all_positions_;
      geometry.colors = all_colors_;
      if (key.textured) geometry.texture_coordinates = all_texture_coordinates_;
      if (key.has_normals) geometry.normals = all_normals_;
    } else {
      geometry.positions = used(all_positions_, geometry.coord_index, all_colors_, geometry.colors);
      if (key.textured) geometry.texture_coordinates = used(all_texture_coordinates_, geometry.texture_index);
      if (key.has_normals) geometry.normals = used(all_normals_, geometry.normal_index);
    }
    if (!keep_drawable(geometry, builder_)) return;
    const std::size_t look = look_of(key.material, key.kind != Geometry::Kind::faces);
    builder_.add_part(std::move(geometry), look, names_.name(key.group));
  }

  /// Moves the points of a part into the geometry, in the order of the file.
  void take_points(Geometry& geometry) {
    const vrml::MFInt32 index = std::move(geometry.coord_index);
    geometry.coord_index.clear();
    Appender<glm::vec3> positions(builder_);
    Appender<vrml::Color> colors(builder_);
    std::size_t missing = 0;
    for (const std::int32_t i : index) {
      const auto at = static_cast<std::size_t>(i);
      if (at >= all_positions_.size()) {
        ++missing;
        continue;
      }
      positions.push(all_positions_[at]);
      if (!all_colors_.empty()) colors.push(all_colors_[at]);
    }
    if (missing > 0) builder_.fail(std::to_string(missing) + " points left out, because they use missing vertices");
    geometry.positions = positions.take();
    geometry.colors = colors.take();
  }

  /// Returns those elements of `all` that `index` refers to, and renumbers `index`. If `extra` is not empty, copies its
  /// elements in parallel to `taken`.
  template <class T>
  Array<T> used(const Array<T>& all, vrml::MFInt32& index, const vrml::MFColor& extra, vrml::MFColor& taken) {
    if (renumbered_.size() < all.size()) renumbered_.resize(all.size(), kNone);
    Appender<T> values(builder_);
    Appender<vrml::Color> colors(builder_);
    std::int32_t* first = index.mutable_data();
    touched_.clear();
    for (std::int32_t* i = first; i != first + index.size(); ++i) {
      if (*i < 0 || static_cast<std::size_t>(*i) >= all.size()) continue;
      std::int32_t& number = renumbered_[static_cast<std::size_t>(*i)];
      if (number == kNone) {
        number = static_cast<std::int32_t>(values.size());
        touched_.push_back(*i);
        values.push(all[static_cast<std::size_t>(*i)]);
        if (!extra.empty()) colors.push(extra[static_cast<std::size_t>(*i)]);
      }
    }
    for (std::int32_t* i = first; i != first + index.size(); ++i) {
      if (*i == kFaceEnd) continue;
      const bool there = *i >= 0 && static_cast<std::size_t>(*i) < all.size();
      *i = there ? renumbered_[static_cast<std::size_t>(*i)] : kBadIndex;
    }
    for (const std::int32_t i : touched_) renumbered_[static_cast<std::size_t>(i)] = kNone;
    taken = colors.take();
    return values.take();
  }
  template <class T>
  Array<T> used(const Array<T>& all, vrml::MFInt32& index) {
    vrml::MFColor none;
    return used(all, index, {}, none);
  }

  std::size_t look_of(std::uint32_t material, bool glows) {
    const auto [entry, added] = looks_.try_emplace({material, glows});
    if (!added) return entry->second;
    const std::string& name = materials_used_.name(material);
    const auto found = materials_.find(name);
    if (found == materials_.end() && !name.empty() && read_file_)
      builder_.warn("material " + name + " is in no library; the default material is used");
    const Look look = found == materials_.end() ? Look{} : found->second;
    return entry->second = builder_.add_look(glows ? glowing(look) : look, name);
  }

  TextCursor cursor_;
  LineCounter lines_;
  MeshBuilder& builder_;
  const ReadFile& read_file_;
  Appender<glm::vec3> positions_{builder_}, normals_{builder_};
  Appender<glm::vec2> texture_coordinates_{builder_};
  Appender<vrml::Color> colors_{builder_};
  vrml::MFVec3f all_positions_, all_normals_;
  vrml::MFVec2f all_texture_coordinates_;
  vrml::MFColor all_colors_;
  Names names_, materials_used_;
  std::map<PartKey, Part> parts_;
  std::vector<std::pair<const PartKey, Part>*> order_;
  PartKey key_;
  Part* current_ = nullptr;
  std::vector<ObjCorner> corners_;  // corners of the current element
  std::vector<std::string> libraries_;
  ObjMaterials materials_;
  std::map<std::pair<std::uint32_t, bool>, std::size_t> looks_;
  std::vector<std::int32_t> renumbered_, touched_;
  bool complained_ = false, full_ = false;
};

/// Imports a Wavefront OBJ file: faces, lines and points, one part per group (o, g) and material (usemtl). `read_file`
/// provides the material libraries (mtllib): Kd, Ks, Ke, Ns, d, Tr, map_Kd. Without it, a note names each library.
/// Colours after the coordinates of `v` become colours of vertices. Curves, surfaces and smoothing groups are ignored.
/// An invalid line gives an error with its location, and its face is skipped.
void import_obj(std::span<const std::byte> bytes, MeshBuilder& builder, const ReadFile& read_file) {
  ObjImporter(bytes, builder, read_file).run();
}

}  // namespace

extern constinit const ContentType kObjFormat = mesh_type("OBJ", "model/obj", ".obj ", nullptr, read_mesh<import_obj>);

}  // namespace gs::app
