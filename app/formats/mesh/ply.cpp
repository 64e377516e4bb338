#include "app/formats/common/content_type.h"
#include "app/formats/common/mesh_asset.h"
#include "app/formats/ply/ply_header.h"
#include "app/formats/ply/ply_source.h"
#include "base/text.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace gs::app {
namespace {

// Value of the constant spherical harmonic. The colour of a splat is 0.5 + kHarmonic0 * f_dc (Kerbl et al. 2023).
constexpr float kHarmonic0 = 0.28209479177387814f;

/// Property names that mean one thing, such as a position, in files of one kind of program.
struct Meaning {
  std::array<std::string_view, 3> names;
  float scale, offset;  // value = scale * number + offset, for floating-point numbers
};
constexpr Meaning kPosition[] = {{{"x", "y", "z"}, 1, 0}};
constexpr Meaning kNormal[] = {{{"nx", "ny", "nz"}, 1, 0}, {{"normal_x", "normal_y", "normal_z"}, 1, 0}};
constexpr Meaning kColor[] = {{{"red", "green", "blue"}, 1, 0},
                              {{"r", "g", "b"}, 1, 0},
                              {{"diffuse_red", "diffuse_green", "diffuse_blue"}, 1, 0},
                              {{"f_dc_0", "f_dc_1", "f_dc_2"}, kHarmonic0, 0.5f}};
constexpr Meaning kTexture[] = {{{"s", "t", {}}, 1, 0},
                                {{"u", "v", {}}, 1, 0},
                                {{"texture_u", "texture_v", {}}, 1, 0},
                                {{"texture_s", "texture_t", {}}, 1, 0}};

/// Destination of one property's values. The value of a row goes to to[row * stride].
struct Column {
  float* to = nullptr;
  std::size_t stride = 0;
  float scale = 1, offset = 0;
};

/// Returns the factor that maps colours of this type to 0..1.
float color_scale(PlyType type) {
  switch (type) {
    case PlyType::int8:
      return 1 / 127.0f;
    case PlyType::int16:
      return 1 / 32767.0f;
    case PlyType::uint16:
      return 1 / 65535.0f;
    case PlyType::float32:
    case PlyType::float64:
      return 1;
    default:
      return 1 / 255.0f;
  }
}

/// First meaning for which the element has all properties, and their indices. `meaning` is null if there is none.
struct FoundProperties {
  const Meaning* meaning = nullptr;
  std::array<std::size_t, 3> at{};
};
FoundProperties find(const PlyElement& element, std::span<const Meaning> meanings) {
  for (const Meaning& meaning : meanings) {
    FoundProperties found{&meaning, {}};
    bool complete = true;
    for (std::size_t i = 0; i < 3 && complete; ++i) {
      if (meaning.names[i].empty()) break;
      const auto property = std::find_if(element.properties.begin(), element.properties.end(),
                                         [&](const auto& p) { return !p.is_list && p.name == meaning.names[i]; });
      complete = property != element.properties.end();
      found.at[i] = static_cast<std::size_t>(property - element.properties.begin());
    }
    if (complete) return found;
  }
  return {};
}

/// Resizes `array` to `rows` and sets the columns of its properties to write into the array. Returns false if
/// properties are missing.
template <class T>
bool connect(const PlyElement& element, std::span<const Meaning> meanings, std::size_t rows, Array<T>& array,
             std::vector<Column>& columns, ImportContext& context) {
  const FoundProperties found = find(element, meanings);
  if (!found.meaning || rows == 0) return false;
  context.draw(rows * sizeof(T));
  array.resize(rows);
  constexpr std::size_t kWidth = sizeof(T) / sizeof(float);
  auto* first = reinterpret_cast<float*>(array.mutable_data());
  for (std::size_t i = 0; i < kWidth; ++i)
    columns[found.at[i]] = {first + i, kWidth, found.meaning->scale, found.meaning->offset};
  return true;
}

void connect_colors(const PlyElement& element, std::size_t rows, vrml::MFColor& colors, std::vector<Column>& columns,
                    ImportContext& context) {
  if (!connect(element, kColor, rows, colors, columns, context)) return;
  const FoundProperties found = find(element, kColor);
  for (const std::size_t i : found.at) columns[i].scale *= color_scale(element.properties[i].type);
}

/// Returns the index of the scalar property. Names are from MeshLab ("quality"), CloudCompare ("scalar_Distance") and
/// others.
std::optional<std::size_t> find_scalar(const PlyElement& element) {
  for (std::size_t i = 0; i < element.properties.size(); ++i) {
    const PlyProperty& property = element.properties[i];
    const std::string_view name = property.name;
    if (!property.is_list && (name == "quality" || name == "scalar" || name == "value" || name.starts_with("scalar_")))
      return i;
  }
  return std::nullopt;
}

/// Returns a title for a scalar property: the name without its prefix, with blanks instead of underscores.
std::string scalar_title(std::string_view property) {
  constexpr std::string_view kBefore = "scalar_";
  if (property.starts_with(kBefore) && property.size() > kBefore.size()) property.remove_prefix(kBefore.size());
  std::string title(property.substr(0, 80));
  std::replace(title.begin(), title.end(), '_', ' ');
  return title;
}

/// Rescales colours to 0..1 if the file has 0..255 as floating-point numbers.
void scale_large_colors(vrml::MFColor& colors) {
  float most = 0;
  for (const vrml::Color& c : colors) most = std::max({most, c.r, c.g, c.b});
  // Bright colours may slightly exceed 1 and need no scaling.
  if (!(most > 4)) return;
  vrml::Color* c = colors.mutable_data();
  for (std::size_t i = 0; i < colors.size(); ++i) c[i] = {c[i].r / 255, c[i].g / 255, c[i].b / 255};
}

template <class Source>
class PlyImporter {
 public:
  PlyImporter(const PlyHeader& header, Source source, MeshBuilder& builder)
      : header_(header), source_(source), builder_(builder) {}

  void run() {
    for (const PlyElement& element : header_.elements)
      if (!read(element)) break;
    build();
  }

 private:
  struct FaceRow {
    std::vector<std::int32_t> corners;
    std::vector<float> texture;
  };

  /// Reads one element. Returns false if the rest of the file is unreadable.
  bool read(const PlyElement& element) {
    if (element.properties.empty() || element.count == 0) return true;
    if (element.name == "vertex" && positions_.empty()) return read_vertices(element);
    if (element.name == "face") return read_faces(element);
    if (element.name == "tristrips") return read_strips(element);
    if (element.name == "edge") return read_edges(element);
    std::vector<Column> none(element.properties.size());
    return complete(element, read_rows(element, element.count, none));
  }

  /// Returns true if all rows of the element were read. Otherwise reports the first missing or invalid row.
  bool complete(const PlyElement& element, std::uint64_t rows) {
    if (rows >= element.count) return true;
    builder_.fail("element " + element.name + ": row " + std::to_string(rows + 1) + " of " +
                      std::to_string(element.count) + " is missing or broken; the rest of the file is skipped",
                  source_.location());
    return false;
  }

  bool read_vertices(const PlyElement& element) {
    if (!find(element, kPosition).meaning) {
      builder_.fail("element vertex has no coordinates; expected the properties x, y and z");
      return false;
    }
    // The number in the header may be wrong. Allocate only for the rows that the file can hold.
    constexpr std::uint64_t kMaxVertices = std::numeric_limits<std::int32_t>::max() - 1;
    const auto rows = static_cast<std::size_t>(std::min({element.count, source_.most_rows(element), kMaxVertices}));
    std::vector<Column> columns(element.properties.size());
    connect(element, kPosition, rows, positions_, columns, builder_);
    connect(element, kNormal, rows, normals_, columns, builder_);
    connect(element, kTexture, rows, texture_coordinates_, columns, builder_);
    connect_colors(element, rows, colors_, columns, builder_);
    // Scalars are shown only if there are no colours and no texture.
    const bool plain = colors_.empty() && header_.texture_file.empty() && rows > 0;
    const std::optional<std::size_t> scalar = plain ? find_scalar(element) : std::nullopt;
    std::vector<float> values;
    if (scalar) {
      builder_.draw(rows * sizeof(float));
      values.resize(rows);
      columns[*scalar] = {values.data(), 1};
    }
    const auto done = static_cast<std::size_t>(read_rows(element, rows, columns));
    positions_.resize(done);
    if (!normals_.empty()) normals_.resize(done);
    if (!texture_coordinates_.empty()) texture_coordinates_.resize(done);
    if (!colors_.empty()) colors_.resize(done);
    values.resize(std::min(values.size(), done));
    if (scalar) color_by(values, scalar_title(element.properties[*scalar].name));
    if (find(element, kColor).meaning == &kColor[3])
      builder_.note("3D Gaussian splats are shown as points of their base colour");
    else
      scale_large_colors(colors_);
    return complete(element, done);
  }

  void color_by(const std::vector<float>& values, std::string title) {
    ColorKey key = color_key_over(values, viridis_colors(), std::move(title));
    builder_.draw(values.size() * sizeof(vrml::Color));
    colors_.resize(values.size());
    vrml::Color* const to = colors_.mutable_data();
    for (std::size_t i = 0; i < values.size(); ++i) to[i] = key.color_of(static_cast<double>(values[i]));
    key_ = std::move(key);
  }

  /// Reads up to `count` rows. Returns the number of complete rows.
  std::uint64_t read_rows(const PlyElement& element, std::uint64_t count, std::vector<Column>& columns) {
    if constexpr (!Source::is_text)
      if (!element.has_lists()) return read_table(element, count, columns);
    for (std::uint64_t row = 0; row < count; ++row)
      for (std::size_t i = 0; i < columns.size(); ++i) {
        const PlyProperty& property = element.properties[i];
        Column& column = columns[i];
        if (property.is_list) {
          if (!skip_list(property)) return row;
        } else if (column.to) {
          float value = 0;
          if (!source_.read(property.type, value)) return row;
          column.to[row * column.stride] = value * column.scale + column.offset;
        } else if (!source_.skip(property.type)) {
          return row;
        }
      }
    return count;
  }

  /// Reads rows of fixed size, column by column. Returns the number of complete rows.
  std::uint64_t read_table(const PlyElement& element, std::uint64_t count,
                           std::vector<Column>& columns) requires(!Source::is_text) {
    const std::size_t stride = element.least_row_bytes();
    const auto rows = static_cast<std::size_t>(std::min<std::uint64_t>(count, source_.bytes().size() / stride));
    const std::byte* from = source_.bytes().data();
    for (std::size_t i = 0; i < columns.size(); ++i) {
      const PlyType type = element.properties[i].type;
      if (const Column column = columns[i]; column.to)
        with_type(type, [&](auto kind) {
          using T = decltype(kind);
          for (std::size_t row = 0; row < rows; ++row)
            column.to[row * column.stride] =
                static_cast<float>(load<T, Source::is_big>(from + row * stride)) * column.scale + column.offset;
        });
      from += size_of(type);
    }
    source_.advance(rows * stride);
    return rows;
  }

  bool list_length(const PlyProperty& property, std::size_t& length) {
    std::int32_t count = 0;
    if (!source_.read_index(property.count_type, count) || count == kBadIndex) return false;
    length = static_cast<std::size_t>(count);
    return source_.may_hold(property.type, length);
  }

  bool skip_list(const PlyProperty& property) {
    std::size_t length = 0;
    if (!list_length(property, length)) return false;
    while (length-- > 0)
      if (!source_.skip(property.type)) return false;
    return true;
  }

  bool read_list(const PlyProperty& property, std::vector<std::int32_t>& to) {
    std::size_t length = 0;
    if (!list_length(property, length)) return false;
    to.resize(length);
    return source_.read_indices(property.type, to);
  }

  bool read_list(const PlyProperty& property, std::vector<float>& to) {
    std::size_t length = 0;
    if (!list_length(property, length)) return false;
    to.resize(length);
    for (float& value : to)
      if (!source_.read(property.type, value)) return false;
    return true;
  }

  bool read_faces(const PlyElement& element) {
    const auto rows = std::min(element.count, source_.most_rows(element));
    std::vector<Column> columns(element.properties.size());
    vrml::MFColor colors;
    connect_colors(element, static_cast<std::size_t>(rows), colors, columns, builder_);
    std::vector<char> kinds;  // per property, i: corner list, t: texture list, c: colour component, -: other
    bool has_texture = false;
    for (std::size_t i = 0; i < columns.size(); ++i) {
      const PlyProperty& p = element.properties[i];
      const bool corners = p.is_list && (p.name == "vertex_indices" || p.name == "vertex_index");
      const bool texture = p.is_list && p.name == "texcoord";
      kinds.push_back(corners ? 'i' : texture ? 't' : columns[i].to ? 'c' : '-');
      has_texture |= texture;
    }
    FaceRow face;
    std::uint64_t row = 0;
    for (; row < rows; ++row) {
      if (!read_face(element, columns, kinds, row, face)) break;
      add_face(face, has_texture);
    }
    if (!colors.empty()) colors.resize(static_cast<std::size_t>(row));
    face_colors_ = std::move(colors);
    scale_large_colors(face_colors_);
    return complete(element, row);
  }

  bool read_face(const PlyElement& element, const std::vector<Column>& columns, const std::vector<char>& kinds,
                 std::uint64_t row, FaceRow& face) {
    face.corners.clear();
    face.texture.clear();
    for (std::size_t i = 0; i < kinds.size(); ++i) {
      const PlyProperty& property = element.properties[i];
      bool good = true;
      float value = 0;
      switch (kinds[i]) {
        case 'i':
          good = read_list(property, face.corners);
          break;
        case 't':
          good = read_list(property, face.texture);
          break;
        case 'c':
          good = source_.read(property.type, value);
          columns[i].to[row * columns[i].stride] = value * columns[i].scale + columns[i].offset;
          break;
        default:
          good = property.is_list ? skip_list(property) : source_.skip(property.type);
      }
      if (!good) return false;
    }
    return true;
  }

  void add_face(const FaceRow& face, bool has_texture) {
    for (const std::int32_t corner : face.corners) coord_index_.push(corner);
    coord_index_.push(kFaceEnd);
    convex_ = convex_ && face.corners.size() <= 3;
    if (!has_texture) return;
    for (std::size_t i = 0; i < face.corners.size(); ++i) {
      const bool there = face.texture.size() >= 2 * (i + 1);
      texture_index_.push(static_cast<std::int32_t>(std::min<std::size_t>(corner_texture_.size(), kBadIndex)));
      corner_texture_.push(there ? glm::vec2(face.texture[2 * i], face.texture[2 * i + 1]) : glm::vec2(0));
    }
    texture_index_.push(kFaceEnd);
  }

  /// Reads triangle strips, which a list holds in sequence, separated by -1.
  bool read_strips(const PlyElement& element) {
    std::vector<std::int32_t> strip;
    std::uint64_t row = 0;
    for (; row < element.count; ++row)
      for (const PlyProperty& property : element.properties) {
        const bool wanted = property.is_list && (property.name == "vertex_indices" || property.name == "vertex_index");
        if (wanted ? !read_list(property, strip)
                   : !(property.is_list ? skip_list(property) : source_.skip(property.type)))
          return complete(element, row);
        if (wanted) add_strip(strip);
      }
    return complete(element, row);
  }

  void add_strip(const std::vector<std::int32_t>& strip) {
    std::size_t start = 0;
    for (std::size_t i = 0; i < strip.size(); ++i) {
      // -1 separates two strips. read_list has converted it to kBadIndex.
      if (strip[i] == kBadIndex) start = i + 1;
      if (i < start + 2) continue;
      const bool turned = ((i - start) & 1) != 0;
      coord_index_.push(strip[turned ? i - 1 : i - 2]);
      coord_index_.push(strip[turned ? i - 2 : i - 1]);
      coord_index_.push(strip[i]);
      coord_index_.push(kFaceEnd);
    }
  }

  bool read_edges(const PlyElement& element) {
    std::uint64_t row = 0;
    for (; row < element.count; ++row) {
      std::array<std::int32_t, 2> ends = {kBadIndex, kBadIndex};
      for (const PlyProperty& property : element.properties) {
        const bool first = property.name == "vertex1", second = property.name == "vertex2";
        const bool good = property.is_list    ? skip_list(property)
                          : (first || second) ? source_.read_index(property.type, ends[second ? 1 : 0])
                                              : source_.skip(property.type);
        if (!good) return complete(element, row);
      }
      edge_index_.push(ends[0]);
      edge_index_.push(ends[1]);
      edge_index_.push(kFaceEnd);
    }
    return complete(element, row);
  }

  [[nodiscard]] bool face_colors_say_more() const {
    if (face_colors_.empty()) return false;
    return std::all_of(colors_.begin(), colors_.end(), [&](const vrml::Color& c) { return c == colors_.front(); });
  }

  void build() {
    if (positions_.empty()) {
      builder_.warn("no vertices in the file");
      return;
    }
    if (key_ && !face_colors_.empty()) {
      key_.reset();
      colors_ = {};
    }
    Geometry geometry;
    const bool faces = !coord_index_.empty(), lines = !faces && !edge_index_.empty();
    geometry.kind = faces ? Geometry::Kind::faces : lines ? Geometry::Kind::lines : Geometry::Kind::points;
    geometry.color_per_vertex = !faces || !face_colors_say_more();
    geometry.colors = geometry.color_per_vertex ? std::move(colors_) : std::move(face_colors_);
    geometry.positions = std::move(positions_);
    geometry.normals = std::move(normals_);
    geometry.texture_coordinates = corner_texture_.empty() ? std::move(texture_coordinates_) : corner_texture_.take();
    geometry.texture_index = texture_index_.take();
    geometry.coord_index = faces ? coord_index_.take() : edge_index_.take();
    geometry.convex = convex_;
    // A scan without normals looks best with smooth shading.
    geometry.crease_angle = std::numbers::pi_v<float>;
    Look look;
    look.texture_url = vrml::String(header_.texture_file);
    if (builder_.add(std::move(geometry), faces ? look : glowing(look)) && key_) builder_.set_color_key(*key_);
  }

  const PlyHeader& header_;
  Source source_;
  MeshBuilder& builder_;
  vrml::MFVec3f positions_, normals_;
  vrml::MFColor colors_, face_colors_;
  std::optional<ColorKey> key_;  // colour key of `colors_`; nullopt if the colours do not represent values
  vrml::MFVec2f texture_coordinates_;
  Appender<glm::vec2> corner_texture_{builder_};
  Appender<std::int32_t> coord_index_{builder_}, texture_index_{builder_}, edge_index_{builder_};
  bool convex_ = true;
};

/// Imports the mesh or points of a PLY file (Turk 1994: ascii, binary_little_endian, binary_big_endian) as one part:
/// faces from `face` or `tristrips` elements, else lines from `edge` elements, else points. Keeps normals, texture
/// coordinates, and colours of vertices or faces (including the constant term of 3D Gaussian splats). Ignores other
/// elements and properties. Colours are display colours; coordinates are unchanged. Memory is bounded by a small
/// multiple of the file size. A truncated file gives an error and its complete rows.
void import_ply(std::span<const std::byte> bytes, MeshBuilder& builder) {
  TextCursor cursor(bytes);
  const auto header = read_ply_header(cursor, builder);
  if (!header) return;
  const auto used = static_cast<std::size_t>(cursor.next - reinterpret_cast<const char*>(bytes.data()));
  const std::span<const std::byte> data = bytes.subspan(used);
  switch (header->format) {
    case PlyFormat::ascii:
      PlyImporter(*header, PlyTextSource(cursor, reinterpret_cast<const char*>(bytes.data())), builder).run();
      break;
    case PlyFormat::little_endian:
      PlyImporter(*header, PlyBinarySource<false>(data), builder).run();
      break;
    case PlyFormat::big_endian:
      PlyImporter(*header, PlyBinarySource<true>(data), builder).run();
      break;
  }
}

bool is_ply(std::span<const std::byte> bytes) {
  const std::string_view text = text_of(bytes);
  return text.starts_with("ply\n") || text.starts_with("ply\r");
}

}  // namespace

extern constinit const ContentType kPlyFormat =
    mesh_type("PLY", "application/x-ply", ".ply ", is_ply, read_mesh<import_ply>, {UpRule::by_shape, true, "ply"});

}  // namespace gs::app
