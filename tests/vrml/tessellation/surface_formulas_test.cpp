// Compares Extrusions, ElevationGrids and IndexedFaceSets of random fields with direct evaluations of their clauses:
// triangles with normals, colours and texture coordinates.
#include "tests/vrml/mesh_formulas.h"
#include "tests/watched.h"

#include <algorithm>
#include <optional>

using namespace gs::vrml;
using namespace gs::vrml::test;

namespace {

/// Rotates `v` about `axis` by the right-hand rule (VRML97 5.8).
glm::dvec3 turned(const glm::dvec3& v, const Rotation& rotation) {
  const glm::dvec3 axis = glm::normalize(glm::dvec3(rotation.x, rotation.y, rotation.z));
  const double c = std::cos(double{rotation.angle}), s = std::sin(double{rotation.angle});
  return v * c + glm::cross(axis, v) * s + axis * (glm::dot(axis, v) * (1 - c));
}

struct ExtrusionFields {
  MFVec2f cross_section;
  MFVec3f spine;
  MFVec2f scale;
  MFRotation orientation;
};

/// Returns Z of a spine-aligned cross-section plane, or nullopt if the three points are collinear.
std::optional<glm::dvec3> z_of(const glm::dvec3& before, const glm::dvec3& here, const glm::dvec3& after) {
  const glm::dvec3 z = glm::cross(glm::normalize(after - here), glm::normalize(before - here));
  return glm::length(z) < 1e-4 ? std::nullopt : std::optional(glm::normalize(z));
}

/// Returns the cross-section at each spine point by VRML97 6.18.3, for spines with some points that are not collinear.
std::vector<std::vector<glm::dvec3>> rings_of(const ExtrusionFields& fields) {
  const std::size_t count = fields.spine.size();
  std::vector<glm::dvec3> p;
  for (const glm::vec3& point : fields.spine) p.emplace_back(point);
  const bool closed = p.front() == p.back();
  std::vector<glm::dvec3> y(count);
  std::vector<std::optional<glm::dvec3>> z(count);
  for (std::size_t i = 1; i + 1 < count; ++i) {
    y[i] = glm::normalize(p[i + 1] - p[i - 1]);
    z[i] = z_of(p[i - 1], p[i], p[i + 1]);
  }
  if (closed) {
    y[0] = y[count - 1] = glm::normalize(p[1] - p[count - 2]);
    z[0] = z[count - 1] = z_of(p[count - 2], p[0], p[1]);
  } else {
    y[0] = glm::normalize(p[1] - p[0]);
    y[count - 1] = glm::normalize(p[count - 1] - p[count - 2]);
  }
  // An undefined Z repeats the previous Z. At the start, it repeats the first defined Z. No Z may reverse.
  const auto first = std::find_if(z.begin(), z.end(), [](const auto& one) { return one.has_value(); });
  if (!z[0]) z[0] = *first;
  for (std::size_t i = 1; i < count; ++i) {
    if (!z[i]) z[i] = z[i - 1];
    if (glm::dot(*z[i], *z[i - 1]) < 0) z[i] = -*z[i];
  }
  if (closed) z[count - 1] = z[0];

  std::vector<std::vector<glm::dvec3>> rings(count);
  for (std::size_t i = 0; i < count; ++i) {
    const glm::dvec3 x = glm::normalize(glm::cross(y[i], *z[i]));
    const glm::dvec2 scale(fields.scale[std::min(i, fields.scale.size() - 1)]);
    const Rotation rotation = fields.orientation[std::min(i, fields.orientation.size() - 1)];
    for (const glm::vec2& c : fields.cross_section) {
      const glm::dvec3 v = turned({c.x * scale.x, 0, c.y * scale.y}, rotation);
      rings[i].push_back(p[i] + x * v.x + y[i] * v.y + *z[i] * v.z);
    }
  }
  return rings;
}

/// Returns the relative lengths along a curve, from 0 to 1.
template <class Points>
std::vector<double> way_along(const Points& points) {
  std::vector<double> way{0};
  for (std::size_t i = 1; i < points.size(); ++i) {
    double square = 0;
    for (int axis = 0; axis < points[i].length(); ++axis)
      square += std::pow(double{points[i][axis]} - double{points[i - 1][axis]}, 2);
    way.push_back(way.back() + std::sqrt(square));
  }
  for (double& w : way) w /= way[points.size() - 1];
  return way;
}

/// Returns a star around the origin, counter-clockwise in (u, v) or seen from -Y of the XZ plane, often concave.
MFVec2f random_star(Random& random, int corners) {
  MFVec2f star;
  for (int i = 0; i < corners; ++i) {
    const double angle = 2 * std::numbers::pi * (i + random.between(0, 0.8)) / corners, radius = random.between(0.3, 1);
    star.push_back({static_cast<float>(radius * std::cos(angle)), static_cast<float>(radius * std::sin(angle))});
  }
  return star;
}

ExtrusionFields random_extrusion(Random& random) {
  ExtrusionFields fields;
  const int corners = 2 + random.below(11);
  fields.cross_section = random_star(random, std::max(3, corners));
  if (corners == 2) fields.cross_section.resize(2);
  if (corners > 2 && random.flip()) fields.cross_section.push_back(fields.cross_section.front());
  const int points = 3 + random.below(7);
  for (int i = 0; i < points; ++i) {
    const glm::vec3 next(random.number(-5, 5), random.number(-5, 5), random.number(-5, 5));
    // Sometimes adds a third collinear point.
    if (i > 0 && random.below(4) == 0) fields.spine.push_back((fields.spine.back() + next) * 0.5f);
    fields.spine.push_back(next);
  }
  if (points > 3 && random.flip()) fields.spine.push_back(fields.spine.front());
  const int scales = random.flip() ? 1 : points, turns = random.flip() ? 1 : points;
  for (int i = 0; i < scales; ++i) fields.scale.push_back({random.number(0.1, 3), random.number(0.1, 3)});
  for (int i = 0; i < turns; ++i)
    fields.orientation.push_back(
        {random.number(-1, 1), random.number(0.1, 1), random.number(-1, 1), random.number(-7, 7)});
  return fields;
}

GeometryScene scene_of(const ExtrusionFields& fields, bool ccw, bool caps) {
  GeometryScene scene("Extrusion");
  scene.set("crossSection", fields.cross_section).set("spine", fields.spine);
  scene.set("scale", fields.scale).set("orientation", fields.orientation);
  scene.set("ccw", ccw).set("beginCap", caps).set("endCap", caps);
  return scene;
}

}  // namespace

TEST_CASE("matches the formulas for sides of random Extrusions (VRML97 6.18)") {
  Random random(618);
  std::size_t compared = 0;
  for (int round = 0; round < 300; round += static_cast<int>(gs::watched_step(9))) {
    const ExtrusionFields fields = random_extrusion(random);
    const bool ccw = random.flip();
    const std::vector<std::vector<glm::dvec3>> rings = rings_of(fields);
    const std::vector<double> s = way_along(fields.cross_section), t = way_along(fields.spine);
    std::vector<FormulaTriangle> expected;
    for (std::size_t i = 0; i + 1 < rings.size(); ++i)
      for (std::size_t j = 0; j + 1 < s.size(); ++j) {
        std::array<FormulaCorner, 4> corners;
        corners[0] = {rings[i][j], {s[j], t[i]}, {}, {}};
        corners[1] = {rings[i][j + 1], {s[j + 1], t[i]}, {}, {}};
        corners[2] = {rings[i + 1][j + 1], {s[j + 1], t[i + 1]}, {}, {}};
        corners[3] = {rings[i + 1][j], {s[j], t[i + 1]}, {}, {}};
        add_quadrilateral(expected, corners, ccw);
      }
    const Mesh mesh = scene_of(fields, ccw, false).mesh();
    const Differences found = differences(mesh, expected, 10, {.texture_coordinate = true});
    INFO("round " << round << ": " << fields.cross_section.size() << " x " << fields.spine.size());
    REQUIRE(found.missing == 0);
    REQUIRE(found.unexpected == 0);
    compared += expected.size();
  }
  CHECK(compared > 100);
}

TEST_CASE("covers the cross-section once by the caps of random Extrusions (VRML97 6.18)") {
  Random random(6185);
  for (int round = 0; round < 300; round += static_cast<int>(gs::watched_step(9))) {
    ExtrusionFields fields = random_extrusion(random);
    if (fields.cross_section.size() < 4) continue;
    const bool ccw = random.flip();
    const std::vector<std::vector<glm::dvec3>> rings = rings_of(fields);
    const Mesh sides = scene_of(fields, ccw, false).mesh(), whole = scene_of(fields, ccw, true).mesh();
    // Computes twice the area of the cross-section from its scaled, rotated and moved corners.
    double area = 0;
    glm::dvec2 lower(1e9), upper(-1e9);
    const MFVec2f& section = fields.cross_section;
    for (std::size_t j = 0; j < section.size(); ++j) {
      const glm::dvec2 a(section[j]), b(section[(j + 1) % section.size()]);
      area += a.x * b.y - a.y * b.x;
      lower = glm::min(lower, a);
      upper = glm::max(upper, a);
    }
    const double longer = std::max(upper.x - lower.x, upper.y - lower.y);
    double expected_area = 0, found_area = 0;
    for (const std::size_t ring : {std::size_t{0}, rings.size() - 1}) {
      const glm::dvec2 scale(fields.scale[std::min(ring, fields.scale.size() - 1)]);
      expected_area += std::abs(area) / 2 * scale.x * scale.y;
    }
    std::size_t wrong = 0;
    for (std::size_t t = triangles_of(sides); t < triangles_of(whole); ++t) {
      found_area += glm::length(area_vector(whole, t)) / 2;
      std::size_t on_begin = 0, on_end = 0;
      for (const FormulaCorner& corner : triangle_of(whole, t)) {
        for (std::size_t j = 0; j < section.size(); ++j) {
          const glm::dvec2 texture = (glm::dvec2(section[j]) - lower) / longer;
          const bool same = glm::length(corner.texture_coordinate - texture) < 1e-4;
          on_begin += same && glm::length(corner.position - rings.front()[j]) < 1e-4;
          on_end += same && glm::length(corner.position - rings.back()[j]) < 1e-4;
          if (on_begin + on_end > 0 && j + 2 == section.size() && section.front() == section.back()) break;
        }
      }
      wrong += on_begin < 3 && on_end < 3;
    }
    INFO("round " << round << ": " << section.size() << " x " << fields.spine.size());
    REQUIRE(wrong == 0);
    REQUIRE(found_area == Approx(expected_area).epsilon(1e-4));
  }
}

TEST_CASE("matches the formulas for random ElevationGrids (VRML97 6.17)") {
  Random random(617);
  for (int round = 0; round < 200; round += static_cast<int>(gs::watched_step(9))) {
    const int columns = 2 + random.below(8), rows = 2 + random.below(8);
    const auto points = static_cast<std::size_t>(columns * rows),
               cells = static_cast<std::size_t>((columns - 1) * (rows - 1));
    const float x_spacing = random.number(0.1, 3), z_spacing = random.number(0.1, 3);
    MFFloat height;
    for (std::size_t i = 0; i < points; ++i) height.push_back(random.number(-2, 2));
    const bool ccw = random.flip(), colored = random.flip(), color_per_vertex = random.flip();
    const bool given_normals = random.flip(), normal_per_vertex = random.flip(), given_texture = random.flip();
    MFColor colors;
    MFVec3f normals;
    MFVec2f texture;
    for (std::size_t i = 0; i < (color_per_vertex ? points : cells); ++i)
      colors.push_back({random.number(0, 1), random.number(0, 1), random.number(0, 1)});
    for (std::size_t i = 0; i < (normal_per_vertex ? points : cells); ++i)
      normals.push_back(
          glm::vec3(glm::normalize(glm::dvec3(random.between(-1, 1), random.between(0.2, 1), random.between(-1, 1)))));
    for (std::size_t i = 0; i < points; ++i) texture.push_back({random.number(-2, 2), random.number(-2, 2)});

    GeometryScene scene("ElevationGrid");
    scene.set("height", height).set("xDimension", columns).set("zDimension", rows);
    scene.set("xSpacing", x_spacing).set("zSpacing", z_spacing).set("ccw", ccw);
    scene.set("colorPerVertex", color_per_vertex).set("normalPerVertex", normal_per_vertex);
    if (colored) scene.colors(colors);
    if (given_normals) scene.normals(normals);
    if (given_texture) scene.texture(texture);

    std::vector<FormulaTriangle> expected;
    for (int j = 0; j + 1 < rows; ++j)
      for (int i = 0; i + 1 < columns; ++i) {
        const auto cell = static_cast<std::size_t>(i + j * (columns - 1));
        const auto corner = [&](int x, int z) {
          const auto at = static_cast<std::size_t>(x + z * columns);
          FormulaCorner result;
          result.position = {double{x_spacing} * x, height[at], double{z_spacing} * z};
          result.texture_coordinate =
              given_texture ? glm::dvec2(texture[at]) : glm::dvec2(double(x) / (columns - 1), double(z) / (rows - 1));
          result.normal = glm::dvec3(normals[normal_per_vertex ? at : cell]);
          const Color& color = colors[color_per_vertex ? at : cell];
          result.color = {color.r, color.g, color.b};
          return result;
        };
        // Counter-clockwise seen from +Y. With creaseAngle 0, each quadrilateral has its own normal.
        std::array<FormulaCorner, 4> corners{corner(i, j), corner(i, j + 1), corner(i + 1, j + 1), corner(i + 1, j)};
        if (!given_normals) {
          const glm::dvec3 normal = glm::normalize(
              glm::cross(corners[2].position - corners[0].position, corners[3].position - corners[1].position));
          for (FormulaCorner& c : corners) c.normal = ccw ? normal : -normal;
        }
        add_quadrilateral(expected, corners, ccw);
      }
    const Mesh mesh = scene.mesh();
    const Differences found =
        differences(mesh, expected, 30, {.texture_coordinate = true, .normal = true, .color = colored});
    INFO("round " << round << ": " << columns << " x " << rows);
    REQUIRE(found.missing == 0);
    REQUIRE(found.unexpected == 0);
  }
}

namespace {

/// Random surface, closed or open: faces of three and four corners of a bent grid.
struct RandomFaces {
  MFVec3f points;
  std::vector<std::vector<int>> faces;
};

RandomFaces random_faces(Random& random) {
  RandomFaces result;
  const int columns = 2 + random.below(4), rows = 2 + random.below(4);
  const auto points = static_cast<std::size_t>(columns * rows);
  for (std::size_t i = 0; i < points; ++i)
    result.points.push_back({static_cast<float>(static_cast<int>(i) % columns) + random.number(-0.2, 0.2),
                             static_cast<float>(static_cast<int>(i) / columns) + random.number(-0.2, 0.2),
                             random.number(-1, 1)});
  for (int j = 0; j + 1 < rows; ++j)
    for (int i = 0; i + 1 < columns; ++i) {
      const int a = j * columns + i, b = a + 1, c = b + columns, d = a + columns;
      if (random.flip()) {
        result.faces.push_back({a, b, c, d});
      } else {
        result.faces.push_back({a, b, c});
        result.faces.push_back({c, d, a});
      }
    }
  return result;
}

/// Returns twice the area vector of a counter-clockwise face.
glm::dvec3 area_of_face(const RandomFaces& all, const std::vector<int>& face) {
  glm::dvec3 sum(0);
  for (std::size_t i = 0; i < face.size(); ++i)
    sum += glm::cross(glm::dvec3(all.points[static_cast<std::size_t>(face[i])]),
                      glm::dvec3(all.points[static_cast<std::size_t>(face[(i + 1) % face.size()])]));
  return sum;
}

/// Returns the normal of a corner by creaseAngle (VRML97 4.6.3.5): the area-weighted mean of the faces at its vertex
/// within the angle. Returns nullopt if an angle is too near to the limit.
std::optional<glm::dvec3> smooth_normal(const RandomFaces& all, std::size_t own, int vertex, double crease_angle) {
  const glm::dvec3 normal = glm::normalize(area_of_face(all, all.faces[own]));
  glm::dvec3 sum(0);
  for (const std::vector<int>& face : all.faces) {
    if (std::find(face.begin(), face.end(), vertex) == face.end()) continue;
    const glm::dvec3 other = area_of_face(all, face);
    const double angle = std::acos(std::clamp(glm::dot(normal, glm::normalize(other)), -1.0, 1.0));
    if (std::abs(angle - crease_angle) < 1e-3) return std::nullopt;
    if (angle < crease_angle || &face == &all.faces[own]) sum += other;
  }
  if (glm::length(sum) < 1e-3) return std::nullopt;
  return glm::normalize(sum);
}

/// Values with their binding to corners (VRML97 6.23): per vertex or face, in order or by index.
struct RandomBinding {
  bool used, per_vertex, indexed;
  MFInt32 index;  // as in the node
  RandomBinding(Random& random, const RandomFaces& all, int values, bool may_be_per_face)
      : used(random.flip()), per_vertex(!may_be_per_face || random.flip()), indexed(random.flip()) {
    if (!indexed) return;
    for (const std::vector<int>& face : all.faces) {
      if (!per_vertex) {
        index.push_back(random.below(values));
        continue;
      }
      for (std::size_t i = 0; i < face.size(); ++i) index.push_back(random.below(values));
      index.push_back(-1);
    }
  }
  /// Returns the index of corner `corner` of face `face`, which starts at `start` in coordIndex.
  [[nodiscard]] std::size_t value(std::size_t face, std::size_t start, std::size_t corner, int vertex) const {
    if (per_vertex) return static_cast<std::size_t>(indexed ? index[start + corner] : vertex);
    return indexed ? static_cast<std::size_t>(index[face]) : face;
  }
};

}  // namespace

TEST_CASE("assigns normals, colours and texture coordinates of random IndexedFaceSets as 6.23 defines (VRML97 6.23)") {
  Random random(623);
  for (int round = 0; round < 400; round += static_cast<int>(gs::watched_step(9))) {
    const RandomFaces all = random_faces(random);
    const int values = static_cast<int>(std::max(all.points.size(), all.faces.size()));
    MFColor colors;
    MFVec3f normals;
    MFVec2f texture;
    for (int i = 0; i < values; ++i) {
      colors.push_back({random.number(0, 1), random.number(0, 1), random.number(0, 1)});
      normals.push_back(
          glm::vec3(glm::normalize(glm::dvec3(random.between(-1, 1), random.between(-1, 1), random.between(0.2, 1)))));
      texture.push_back({random.number(-2, 2), random.number(-2, 2)});
    }
    const RandomBinding color(random, all, values, true), normal(random, all, values, true),
        coordinate(random, all, values, false);
    const bool ccw = random.flip();
    const float crease_angle = random.flip() ? 0 : random.number(0.1, 3);
    MFInt32 coord_index;
    for (const std::vector<int>& face : all.faces) {
      for (const int vertex : face) coord_index.push_back(vertex);
      coord_index.push_back(-1);
    }
    if (random.flip()) coord_index.resize(coord_index.size() - 1);

    GeometryScene scene("IndexedFaceSet");
    scene.points(all.points).set("coordIndex", coord_index).set("ccw", ccw).set("creaseAngle", crease_angle);
    if (color.used) scene.colors(colors).set("colorPerVertex", color.per_vertex).set("colorIndex", color.index);
    if (normal.used) scene.normals(normals).set("normalPerVertex", normal.per_vertex).set("normalIndex", normal.index);
    if (coordinate.used) scene.texture(texture).set("texCoordIndex", coordinate.index);

    // Default texture coordinates: S along the longest side of the box, T along the next one, X before Y before Z.
    glm::dvec3 lower(1e9), upper(-1e9);
    for (const glm::vec3& point : all.points) {
      lower = glm::min(lower, glm::dvec3(point));
      upper = glm::max(upper, glm::dvec3(point));
    }
    const glm::dvec3 size = upper - lower;
    std::array<int, 3> axes{0, 1, 2};
    std::stable_sort(axes.begin(), axes.end(), [&](int a, int b) { return size[a] > size[b]; });

    std::vector<FormulaTriangle> expected;
    bool clear = true;
    std::size_t start = 0;
    for (std::size_t f = 0; f < all.faces.size(); ++f) {
      const std::vector<int>& face = all.faces[f];
      std::vector<FormulaCorner> corners(face.size());
      for (std::size_t i = 0; i < face.size(); ++i) {
        FormulaCorner& corner = corners[i];
        corner.position = glm::dvec3(all.points[static_cast<std::size_t>(face[i])]);
        const glm::dvec3 in_box = corner.position - lower;
        corner.texture_coordinate = glm::dvec2(in_box[axes[0]], in_box[axes[1]]) / size[axes[0]];
        if (coordinate.used) corner.texture_coordinate = glm::dvec2(texture[coordinate.value(f, start, i, face[i])]);
        const Color& c = colors[color.value(f, start, i, face[i])];
        corner.color = {c.r, c.g, c.b};
        if (normal.used) {
          corner.normal = glm::dvec3(normals[normal.value(f, start, i, face[i])]);
        } else {
          const std::optional<glm::dvec3> smooth = smooth_normal(all, f, face[i], crease_angle);
          clear = clear && smooth;
          corner.normal = smooth.value_or(glm::dvec3(0)) * (ccw ? 1.0 : -1.0);
        }
      }
      for (std::size_t i = 2; i < corners.size(); ++i) {
        FormulaTriangle triangle{corners[0], corners[i - 1], corners[i]};
        if (!ccw) std::swap(triangle[1], triangle[2]);
        expected.push_back(triangle);
      }
      start += face.size() + 1;
    }
    const Mesh mesh = scene.mesh();
    const Differences found =
        differences(mesh, expected, 5, {.texture_coordinate = true, .normal = clear, .color = color.used});
    INFO("round " << round << ": " << all.faces.size() << " faces, creaseAngle " << crease_angle);
    REQUIRE(found.missing == 0);
    REQUIRE(found.unexpected == 0);
  }
}

TEST_CASE("covers random concave faces once, by triangles inside them (VRML97 6.23, convex FALSE)") {
  Random random(6231);
  for (int round = 0; round < 400; round += static_cast<int>(gs::watched_step(9))) {
    const int count = 4 + random.below(30);
    const MFVec2f star = random_star(random, count);
    // Moves into a random plane.
    const glm::dvec3 normal = glm::normalize(
        glm::dvec3(random.between(-1, 1), random.between(-1, 1), random.between(-1, 1)) + glm::dvec3(1e-3));
    const glm::dvec3 u =
        glm::normalize(glm::cross(normal, std::abs(normal.x) < 0.7 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0)));
    const glm::dvec3 v = glm::cross(normal, u), origin(random.between(-3, 3), random.between(-3, 3), 1);
    MFVec3f points;
    MFInt32 index;
    double area = 0;
    for (int i = 0; i < count; ++i) {
      const glm::dvec2 a(star[static_cast<std::size_t>(i)]), b(star[static_cast<std::size_t>((i + 1) % count)]);
      points.push_back(glm::vec3(origin + u * a.x + v * a.y));
      index.push_back(i);
      area += (a.x * b.y - a.y * b.x) / 2;
    }
    const bool ccw = random.flip();
    const Mesh mesh = GeometryScene("IndexedFaceSet")
                          .points(points)
                          .set("coordIndex", index)
                          .set("convex", false)
                          .set("ccw", ccw)
                          .mesh();
    std::size_t wrong = 0;
    for (std::size_t t = 0; t < triangles_of(mesh); ++t) {
      const glm::dvec3 looks = area_vector(mesh, t);
      wrong += glm::dot(looks, normal) * (ccw ? 1 : -1) < -1e-6;
      for (const FormulaCorner& corner : triangle_of(mesh, t))
        wrong += glm::length(corner.normal - normal * (ccw ? 1.0 : -1.0)) > 1e-3;
      // The centre of a triangle is inside the star: a ray from it crosses the border an odd number of times.
      const FormulaTriangle triangle = triangle_of(mesh, t);
      const glm::dvec3 middle = (triangle[0].position + triangle[1].position + triangle[2].position) / 3.0 - origin;
      const glm::dvec2 p(glm::dot(middle, u), glm::dot(middle, v));
      bool inside = false;
      for (int i = 0; i < count; ++i) {
        const glm::dvec2 a(star[static_cast<std::size_t>(i)]), b(star[static_cast<std::size_t>((i + 1) % count)]);
        if ((a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x)) inside = !inside;
      }
      wrong += !inside && glm::length(looks) > 1e-5;
    }
    INFO("round " << round << ": " << count << " corners");
    REQUIRE(wrong == 0);
    REQUIRE(area_of(mesh) == Approx(area).epsilon(1e-4));
  }
}
