// bench_inputs DIR: writes the worlds that benchmarks read, with the same bytes in every run.
//
// Three height fields (long arrays of numbers), one of them also as X3D in XML and JSON, and five worlds of many small
// objects that load different parts of a browser: names, nodes, sharing, PROTO instances, ROUTEs, meshes.

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

namespace {

/// Writer of a text file. Remembers a failure instead of throwing.
class Writer {
 public:
  explicit Writer(const std::filesystem::path& path) : file_(std::fopen(path.c_str(), "wb"), &std::fclose) {}

  Writer& text(std::string_view text) {
    buffer_ += text;
    if (buffer_.size() > kBlock) flush();
    return *this;
  }
  Writer& integer(long value) {
    std::array<char, 24> digits;
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
    return text({digits.data(), end});
  }
  /// Writes a number with `decimals` digits after the point.
  Writer& number(double value, int decimals) {
    std::array<char, 64> digits;
    const auto end =
        std::to_chars(digits.data(), digits.data() + digits.size(), value, std::chars_format::fixed, decimals).ptr;
    return text({digits.data(), end});
  }
  Writer& triple(double x, double y, double z, int decimals) {
    return number(x, decimals).text(" ").number(y, decimals).text(" ").number(z, decimals);
  }
  /// Returns false if a write failed.
  [[nodiscard]] bool finish() {
    flush();
    return good_ && std::fflush(file_.get()) == 0;
  }

 private:
  void flush() {
    good_ = good_ && file_ && std::fwrite(buffer_.data(), 1, buffer_.size(), file_.get()) == buffer_.size();
    buffer_.clear();
  }

  static constexpr std::size_t kBlock = 1 << 20;
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> file_;
  std::string buffer_;
  bool good_ = true;
};

void write_head(Writer& out, std::string_view sky, std::string_view viewpoint) {
  out.text("#VRML V2.0 utf8\nNavigationInfo { type [ \"EXAMINE\" \"ANY\" ] }\nBackground { skyColor [ ").text(sky);
  out.text(" ] }\nViewpoint { ").text(viewpoint).text(" description \"Front\" }\n");
}

/// Rolling hills over 16 m x 16 m: a sum of waves with heights and frequencies along x and z.
struct Hills {
  struct Wave {
    double height, along_x, along_z, phase;
  };
  static constexpr std::array<Wave, 3> kWaves{{{1.0, 0.8, 0.75, 0.3}, {0.4, 2.1, 2.4, 1.1}, {0.06, 8.5, 9.5, 2.0}}};

  static double height(double x, double z) {
    double sum = 0;
    for (const Wave& w : kWaves) sum += w.height * std::sin(w.along_x * x + w.phase) * std::cos(w.along_z * z);
    return sum;
  }
  static std::array<double, 3> normal(double x, double z) {
    double slope_x = 0, slope_z = 0;
    for (const Wave& w : kWaves) {
      slope_x += w.height * w.along_x * std::cos(w.along_x * x + w.phase) * std::cos(w.along_z * z);
      slope_z -= w.height * w.along_z * std::sin(w.along_x * x + w.phase) * std::sin(w.along_z * z);
    }
    const double length = std::sqrt(slope_x * slope_x + slope_z * slope_z + 1);
    return {-slope_x / length, 1 / length, -slope_z / length};
  }
};

/// Lists of numbers of a height field with n x n vertices and 2 (n - 1)^2 triangles.
class HeightField {
 public:
  /// `inside` stands between the numbers of a vertex.
  HeightField(Writer& out, int n, std::string_view inside) : out_(out), n_(n), inside_(inside) {}

  void write_points() {
    write_rows([&](double x, double z) { triple(x, Hills::height(x, z), z, 6); });
  }
  void write_normals() {
    write_rows([&](double x, double z) {
      const auto normal = Hills::normal(x, z);
      triple(normal[0], normal[1], normal[2], 5);
    });
  }
  void write_colors() {
    write_rows([&](double x, double z) {
      const double t = std::clamp((Hills::height(x, z) + 1.4) / 2.8, 0.0, 1.0);
      triple(0.15 + 0.8 * t, 0.6 - 0.4 * std::abs(t - 0.4), 0.8 - 0.6 * t, 4);
    });
  }
  void write_indices() {
    const auto face = [&](long a, long b, long c, bool last) {
      out_.integer(a).text(", ").integer(b).text(", ").integer(c).text(last ? ", -1" : ", -1, ");
    };
    for (long row = 0; row + 1 < n_; ++row) {
      out_.text("   ");
      for (long column = 0; column + 1 < n_; ++column) {
        const long near = row * n_ + column, far = near + n_;
        face(near, far, near + 1, false);
        face(near + 1, far, far + 1, row + 2 == n_ && column + 2 == n_);
      }
      out_.text("\n");
    }
  }

 private:
  template <class Write>
  void write_rows(Write&& write_vertex) {
    const auto place = [this](int i) { return -8 + 16.0 * i / (n_ - 1); };
    for (int row = 0; row < n_; ++row) {
      out_.text("   ");
      for (int column = 0; column < n_; ++column) {
        write_vertex(place(column), place(row));
        out_.text(column + 1 < n_ ? ", " : row + 1 < n_ ? ",\n" : "\n");
      }
    }
  }
  void triple(double x, double y, double z, int decimals) {
    out_.number(x, decimals).text(inside_).number(y, decimals).text(inside_).number(z, decimals);
  }

  Writer& out_;
  int n_;
  std::string_view inside_;
};

/// Writes a height field as one IndexedFaceSet with normals and colours per vertex.
bool write_height_field(const std::filesystem::path& path, int n) {
  Writer out(path);
  HeightField field(out, n, " ");
  write_head(out, "0.2 0.3 0.5", "position 0 9 13 orientation 1 0 0 -0.61");
  out.text("DEF Terrain Shape {\n appearance Appearance { material Material { diffuseColor 0.8 0.8 0.8 } }\n");
  out.text(" geometry IndexedFaceSet {\n  solid FALSE\n  coord Coordinate { point [\n");
  field.write_points();
  out.text("  ] }\n  normal Normal { vector [\n");
  field.write_normals();
  out.text("  ] }\n  color Color { color [\n");
  field.write_colors();
  out.text("  ] }\n  coordIndex [\n");
  field.write_indices();
  out.text("  ]\n } }\n");
  return out.finish();
}

/// Writes the same height field as X3D in XML.
bool write_xml_height_field(const std::filesystem::path& path, int n) {
  Writer out(path);
  HeightField field(out, n, " ");
  out.text(R"(<?xml version="1.0" encoding="UTF-8"?>
<X3D profile="Interchange" version="3.3"><Scene>
<NavigationInfo type='"EXAMINE" "ANY"'/><Background skyColor="0.2 0.3 0.5"/>
<Viewpoint position="0 9 13" orientation="1 0 0 -0.61" description="Front"/>
<Shape DEF="Terrain"><Appearance><Material diffuseColor="0.8 0.8 0.8"/></Appearance>
<IndexedFaceSet solid="false" coordIndex="
)");
  field.write_indices();
  out.text("\"><Coordinate point=\"\n");
  field.write_points();
  out.text("\"/>\n<Normal vector=\"\n");
  field.write_normals();
  out.text("\"/>\n<Color color=\"\n");
  field.write_colors();
  out.text("\"/></IndexedFaceSet></Shape></Scene></X3D>\n");
  return out.finish();
}

/// Writes the same height field as X3D in JSON.
bool write_json_height_field(const std::filesystem::path& path, int n) {
  Writer out(path);
  HeightField field(out, n, ",");
  out.text(R"({"X3D":{"encoding":"UTF-8","@profile":"Interchange","@version":"3.3","Scene":{"-children":[
{ "NavigationInfo":{"@type":["EXAMINE","ANY"]}}, { "Background":{"@skyColor":[0.2,0.3,0.5]}},
{ "Viewpoint":{"@position":[0,9,13],"@orientation":[1,0,0,-0.61],"@description":"Front"}},
{ "Shape":{"@DEF":"Terrain","-appearance":{ "Appearance":{"-material":{ "Material":{"@diffuseColor":[0.8,0.8,0.8]}}}},
"-geometry":{ "IndexedFaceSet":{"@solid":false,"@coordIndex":[
)");
  field.write_indices();
  out.text("],\"-coord\":{ \"Coordinate\":{\"@point\":[\n");
  field.write_points();
  out.text("]}},\n\"-normal\":{ \"Normal\":{\"@vector\":[\n");
  field.write_normals();
  out.text("]}},\n\"-color\":{ \"Color\":{\"@color\":[\n");
  field.write_colors();
  out.text("]}}}}}}]}}}\n");
  return out.finish();
}

/// Writes 20,000 `Transform { Shape }` with DEF names; USE shares 4 geometries and 8 appearances.
bool write_small_nodes(const std::filesystem::path& path) {
  static constexpr std::array<std::string_view, 8> kColors{"0.9 0.2 0.2", "0.2 0.8 0.3", "0.2 0.4 0.9", "0.9 0.8 0.1",
                                                           "0.8 0.3 0.8", "0.3 0.8 0.8", "0.9 0.5 0.2", "0.7 0.7 0.7"};
  static constexpr std::array<std::string_view, 4> kGeometries{
      "Box { size 0.4 0.4 0.4 }", "Sphere { radius 0.22 }", "Cone { bottomRadius 0.22 height 0.42 }",
      "IndexedFaceSet { creaseAngle 0.5 coord Coordinate { point [ -0.2 -0.2 0.2, 0.2 -0.2 0.2, 0.2 0.2 0.2, "
      "-0.2 0.2 0.2, 0 0 -0.25 ] } coordIndex [ 0 1 2 3 -1 1 0 4 -1 2 1 4 -1 3 2 4 -1 0 3 4 -1 ] }"};
  constexpr int kColumns = 200, kRows = 100;
  Writer out(path);
  write_head(out, "0.05 0.05 0.1", "position 0 0 90");
  out.text("Group { children [\n");
  for (int i = 0; i < kColumns * kRows; ++i) {
    const int column = i % kColumns, row = i / kColumns;
    out.text(" DEF Item").integer(i).text(" Transform { translation ");
    out.triple((column - 99.5) * 0.55, (row - 49.5) * 0.62, 3 * std::sin(column * 0.11) * std::cos(row * 0.17), 4);
    out.text(" rotation 0.267 0.535 0.802 ")
        .number(std::fmod(i * 0.37, 6.28), 4)
        .text(" children [ Shape { appearance ");
    if (i < 8) {
      out.text("DEF Look").integer(i).text(" Appearance { material Material { diffuseColor ").text(kColors[i]);
      out.text(" specularColor 0.2 0.2 0.2 shininess 0.3 } }");
    } else {
      out.text("USE Look").integer(i % 8);
    }
    out.text(" geometry ");
    if (i < 4) {
      out.text("DEF Form").integer(i).text(" ").text(kGeometries[i]);
    } else {
      out.text("USE Form").integer(i % 4);
    }
    out.text(" } ] }\n");
  }
  out.text("] }\n");
  return out.finish();
}

/// Writes 5,000 instances of one PROTO of 6 fields and 2 Shapes.
bool write_prototypes(const std::filesystem::path& path) {
  Writer out(path);
  write_head(out, "0.1 0.05 0.05", "position 0 0 60");
  out.text(R"(PROTO Pawn [
  exposedField SFVec3f    translation  0 0 0
  exposedField SFRotation rotation     0 0 1 0
  exposedField SFFloat    transparency 0
  field        SFVec3f    foot         1 1 1
  field        SFFloat    head         0.2
  field        SFColor    color        0.8 0.8 0.8
] {
  Transform {
    translation IS translation
    rotation IS rotation
    children [
      Shape {
        appearance Appearance { material Material { diffuseColor IS color transparency IS transparency } }
        geometry Box { size IS foot }
      }
      Transform {
        translation 0 0.3 0
        children Shape {
          appearance Appearance { material Material { diffuseColor IS color emissiveColor 0.2 0.1 0 } }
          geometry Sphere { radius IS head }
        }
      }
    ]
  }
}
Group { children [
)");
  for (int i = 0; i < 5000; ++i) {
    const int column = i % 100, row = i / 100;
    out.text(" Pawn { translation ");
    out.triple((column - 49.5) * 0.7, (row - 24.5) * 0.85, 1.5 * std::sin(column * 0.2) * std::cos(row * 0.3), 4);
    out.text(" rotation 0.267 0.535 0.802 ").number(std::fmod(i * 0.37, 6.28), 4);
    out.text(" foot ").triple(0.3 + 0.1 * (i % 3), 0.3, 0.25 + 0.05 * (i % 4), 3);
    out.text(" color ").triple(0.3 + 0.07 * (i * 7 % 11), 0.3 + 0.058 * (i * 5 % 13), 0.3 + 0.043 * (i * 3 % 17), 3);
    out.text(" head ").number(0.12 + 0.02 * (i % 5), 3).text(" transparency 0 }\n");
  }
  out.text("] }\n");
  return out.finish();
}

/// Writes 10,000 ROUTEs: from one clock to 5,000 PositionInterpolators, and to their Transforms.
bool write_routes(const std::filesystem::path& path) {
  constexpr int kObjects = 5000;
  Writer out(path);
  write_head(out, "0 0.1 0.1", "position 0 0 60");
  out.text("DEF Clock TimeSensor { cycleInterval 4 loop TRUE }\n");
  for (int i = 0; i < kObjects; ++i) {
    const double x = (i % 100 - 49.5) * 0.7, y = (i / 100 - 24.5) * 0.85;
    out.text("DEF Block").integer(i).text(" Transform { translation ").triple(x, y, 0, 4).text(" children ");
    if (i == 0) {
      out.text(
          "DEF Form Shape { appearance Appearance { material Material { diffuseColor 0.9 0.6 0.2 } } "
          "geometry Box { size 0.4 0.4 0.4 } }");
    } else {
      out.text("USE Form");
    }
    out.text(" }\nDEF Path").integer(i).text(" PositionInterpolator { key [ 0 0.25 0.5 0.75 1 ] keyValue [ ");
    out.triple(x, y, 0, 4).text(", ").triple(x + 0.2, y, 1, 4).text(", ").triple(x + 0.2, y + 0.2, 2, 4).text(", ");
    out.triple(x, y + 0.2, 1, 4).text(", ").triple(x, y, 0, 4).text(" ] }\n");
  }
  for (int i = 0; i < kObjects; ++i) {
    out.text("ROUTE Clock.fraction_changed TO Path").integer(i).text(".set_fraction\nROUTE Path").integer(i);
    out.text(".value_changed TO Block").integer(i).text(".set_translation\n");
  }
  return out.finish();
}

/// Writes 10,000 labels in view, with different strings.
bool write_labels(const std::filesystem::path& path) {
  constexpr std::array kWords = {"north", "Gate",  "valve", "pump",   "T-104",   "reactor", "temperature", "Level",
                                 "inlet", "depot", "Quai",  "bridge", "harbour", "mast",    "22.4 m",      "river"};
  Writer out(path);
  write_head(out, "0 0.1 0.1", "position 0 0 130");
  for (std::size_t i = 0; i < 10'000; ++i) {
    const auto column = static_cast<double>(i % 100), row = static_cast<double>(i / 100);
    out.text("Transform { translation ");
    out.triple((column - 54) * 1.1, (row - 49.5) * 0.9, static_cast<double>(i * 37 % 121) - 60, 3);
    out.text(
        i == 0 ? " children Shape { appearance DEF Paint Appearance { material Material { diffuseColor 0.9 0.9 0.5 } }"
               : " children Shape { appearance USE Paint");
    out.text(" geometry Text { string \"").text(kWords[i * 7 % kWords.size()]).text(" ");
    out.text(kWords[(i * 5 + i / 16) % kWords.size()]).text(" ").integer(static_cast<long>(i)).text("\" fontStyle ");
    out.text(i == 0 ? "DEF Style FontStyle { family \"SANS\" size 0.6 }" : "USE Style").text(" } } }\n");
  }
  return out.finish();
}

/// Writes 20,000 Shapes in view, each with an own mesh of 200 triangles and one of 8 appearances.
bool write_many_meshes(const std::filesystem::path& path) {
  constexpr int kColumns = 200, kRows = 100, kSide = 11;
  Writer out(path);
  write_head(out, "0.05 0.05 0.1", "position 0 60 110 orientation 1 0 0 -0.5");
  out.text("Group { children [\n");
  for (int i = 0; i < kColumns * kRows; ++i) {
    const int column = i % kColumns, row = i / kColumns;
    out.text(" Transform { translation ").triple((column - 100) * 0.6, 0, (row - 50) * 0.9, 2);
    if (i < 8) {
      out.text(" children Shape { appearance DEF Look").integer(i);
      out.text(" Appearance { material Material { diffuseColor ");
      out.triple(0.3 + 0.1 * (i % 7), 0.9 - 0.1 * i, 0.2 + 0.3 * (i % 3), 2).text(" } }");
    } else {
      out.text(" children Shape { appearance USE Look").integer(i % 8);
    }
    out.text(
        " geometry ElevationGrid { xDimension 11 zDimension 11 xSpacing 0.055 zSpacing 0.085 creaseAngle 3 height [");
    for (int point = 0; point < kSide * kSide; ++point) {
      const double x = column * 0.3 + point % kSide * 0.0275, z = row * 0.45 + point / kSide * 0.0425;
      out.text(" ").number(3 * Hills::height(x, z) + 0.1 * std::sin(i + point), 3);
    }
    out.text(" ] } } }\n");
  }
  out.text("] }\n");
  return out.finish();
}

}  // namespace

int main(int count, char** arguments) {
  // A word that begins with "-" is an option, not the name of a folder.
  const std::string_view word = count == 2 ? arguments[1] : "";
  if (word.empty() || word.starts_with('-')) {
    std::fputs("usage: bench_inputs DIR\nWrites ten worlds for the benchmarks into DIR.\n", stderr);
    return word == "--help" || word == "-h" ? 0 : 2;
  }
  const std::filesystem::path folder = arguments[1];
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  const bool good = write_height_field(folder / "grid100k.wrl", 225) &&  // 100,352 triangles
                    write_height_field(folder / "grid1m.wrl", 708) &&    // 999,698
                    write_xml_height_field(folder / "grid1m.x3d", 708) &&
                    write_json_height_field(folder / "grid1m.x3dj", 708) &&
                    write_height_field(folder / "grid4m.wrl", 1415) &&  // 3,998,792
                    write_small_nodes(folder / "nodes20k.wrl") && write_prototypes(folder / "proto5k.wrl") &&
                    write_routes(folder / "routes10k.wrl") && write_labels(folder / "labels10k.wrl") &&
                    write_many_meshes(folder / "shapes20k.wrl");
  if (!good) std::fprintf(stderr, "bench_inputs: cannot write into %s\n", folder.c_str());
  return good ? 0 : 1;
}
