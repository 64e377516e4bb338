#include "tests/vrml/mesh_checks.h"

#include <limits>
#include <random>

using namespace gs::vrml;
using namespace gs::vrml::test;

namespace {

/// Random field values, mostly plausible, the same in every run.
class Dice {
 public:
  explicit Dice(std::uint32_t seed) : random_(seed) {}

  int below(int end) { return static_cast<int>(random_() % static_cast<std::uint32_t>(end)); }
  bool flip() { return below(2) == 0; }
  float number() {
    static constexpr float kOdd[] = {0,
                                     -0.0f,
                                     1e-40f,
                                     3e38f,
                                     -3e38f,
                                     1e-7f,
                                     std::numeric_limits<float>::infinity(),
                                     std::numeric_limits<float>::quiet_NaN()};
    return below(odd_) == 0 ? kOdd[below(8)] : static_cast<float>(below(21) - 10) / 4;
  }
  int index(int count) {
    static constexpr int kOdd[] = {-2, 2147483647, -2147483647 - 1, 100000};
    if (below(5) == 0) return -1;
    return below(odd_) == 0 ? kOdd[below(4)] : below(count);
  }
  MFInt32 indices(int most, int count) {
    MFInt32 list;
    for (int i = below(most); i > 0; --i) list.push_back(index(count));
    return list;
  }
  MFFloat numbers(int most) {
    MFFloat list;
    for (int i = below(most); i > 0; --i) list.push_back(number());
    return list;
  }
  MFVec2f pairs(int most) {
    MFVec2f list;
    for (int i = below(most); i > 0; --i) list.push_back({number(), number()});
    return list;
  }
  MFVec3f triples(int most) {
    MFVec3f list;
    for (int i = below(most); i > 0; --i) list.push_back({number(), number(), number()});
    return list;
  }
  MFColor colors(int most) {
    MFColor list;
    for (int i = below(most); i > 0; --i) list.push_back({number(), number(), number()});
    return list;
  }
  MFRotation rotations(int most) {
    MFRotation list;
    for (int i = below(most); i > 0; --i) list.push_back({number(), number(), number(), number()});
    return list;
  }
  /// Sets the rarity of odd values.
  void set_odd(int odd) { odd_ = odd; }

 private:
  std::mt19937 random_;
  int odd_ = 20;
};

template <class Fill>
void throw_at(const char* type, int rounds, const Fill& fill, Language language = Language::vrml97) {
  Dice dice(12345);
  std::size_t drawn = 0;
  for (int round = 0; round < rounds; ++round) {
    dice.set_odd(round % 3 == 0 ? 1000000 : round % 3 == 1 ? 20 : 4);
    GeometryScene scene(type, language);
    fill(scene, dice);
    const Mesh mesh =
        scene.mesh({.segments = dice.below(10), .texture_coordinates = dice.flip(), .line_lengths = dice.flip()});
    check_promises(mesh, false);
    drawn += mesh.indices.size();
  }
  CHECK(drawn > 0);
}

}  // namespace

TEST_CASE("makes valid meshes of random IndexedFaceSets") {
  throw_at("IndexedFaceSet", 3000, [](GeometryScene& scene, Dice& dice) {
    scene.points(dice.triples(30));
    if (dice.flip()) scene.normals(dice.triples(30));
    if (dice.flip()) scene.colors(dice.colors(30));
    if (dice.flip()) scene.texture(dice.pairs(30));
    const MFInt32 index = dice.indices(120, 32);
    scene.set("coordIndex", index);
    if (dice.flip()) scene.set("normalIndex", dice.flip() ? index : dice.indices(120, 32));
    if (dice.flip()) scene.set("colorIndex", dice.flip() ? index : dice.indices(120, 32));
    if (dice.flip()) scene.set("texCoordIndex", dice.flip() ? index : dice.indices(120, 32));
    for (const char* field : {"ccw", "solid", "convex", "normalPerVertex", "colorPerVertex"})
      scene.set(field, dice.flip());
    if (dice.flip()) scene.set<SFFloat>("creaseAngle", dice.number());
  });
}

TEST_CASE("makes valid meshes of random large concave faces") {
  throw_at("IndexedFaceSet", 60, [](GeometryScene& scene, Dice& dice) {
    MFVec3f points;
    while (points.size() < 400) points.append(dice.triples(100).span());
    scene.points(points);
    MFInt32 index;
    for (int i = dice.below(3000); i > 0; --i) index.push_back(dice.below(400));
    scene.set("coordIndex", index).set("convex", false);
  });
}

TEST_CASE("makes valid meshes of random IndexedFaceSets with few faces out of many points") {
  throw_at("IndexedFaceSet", 60, [](GeometryScene& scene, Dice& dice) {
    MFVec3f points;
    while (points.size() < 1500) points.append(dice.triples(100).span());
    scene.points(points).set("coordIndex", dice.indices(300, 1600));
    if (dice.flip()) scene.normals(points);
    if (dice.flip()) scene.colors(dice.colors(2000));
    if (dice.flip()) scene.texture(dice.pairs(2000));
    scene.set<SFFloat>("creaseAngle", dice.number());
  });
}

TEST_CASE("makes valid meshes of random IndexedLineSets and PointSets") {
  throw_at("IndexedLineSet", 1500, [](GeometryScene& scene, Dice& dice) {
    scene.points(dice.triples(30)).set("coordIndex", dice.indices(60, 32));
    if (dice.flip()) scene.colors(dice.colors(30));
    if (dice.flip()) scene.set("colorIndex", dice.indices(60, 32));
    scene.set("colorPerVertex", dice.flip());
  });
  throw_at("PointSet", 300, [](GeometryScene& scene, Dice& dice) {
    scene.points(dice.triples(30));
    if (dice.flip()) scene.colors(dice.colors(30));
  });
}

TEST_CASE("makes valid meshes of random ElevationGrids") {
  throw_at("ElevationGrid", 1500, [](GeometryScene& scene, Dice& dice) {
    scene.set("height", dice.numbers(200));
    scene.set<SFInt32>("xDimension", dice.index(14)).set<SFInt32>("zDimension", dice.index(14));
    if (dice.flip()) scene.set<SFFloat>("xSpacing", dice.number());
    if (dice.flip()) scene.set<SFFloat>("creaseAngle", dice.number());
    if (dice.flip()) scene.normals(dice.triples(200));
    if (dice.flip()) scene.colors(dice.colors(200));
    if (dice.flip()) scene.texture(dice.pairs(200));
    for (const char* field : {"ccw", "solid", "normalPerVertex", "colorPerVertex"}) scene.set(field, dice.flip());
  });
}

TEST_CASE("makes valid meshes of random Extrusions") {
  throw_at("Extrusion", 1500, [](GeometryScene& scene, Dice& dice) {
    MFVec2f section = dice.pairs(12);
    MFVec3f spine = dice.triples(12);
    if (dice.flip() && !section.empty()) section.push_back(section.front());
    if (dice.flip() && !spine.empty()) spine.push_back(spine.front());
    if (dice.flip() && !spine.empty()) spine.push_back(spine.back());
    scene.set("crossSection", section).set("spine", spine);
    if (dice.flip()) scene.set("scale", dice.pairs(12));
    if (dice.flip()) scene.set("orientation", dice.rotations(12));
    if (dice.flip()) scene.set<SFFloat>("creaseAngle", dice.number());
    for (const char* field : {"ccw", "solid", "convex", "beginCap", "endCap"}) scene.set(field, dice.flip());
  });
}

TEST_CASE("makes valid meshes of random triangle, line and point sets of X3D") {
  const auto properties = [](GeometryScene& scene, Dice& dice) {
    scene.points(dice.triples(30));
    if (dice.flip()) scene.normals(dice.triples(30));
    if (dice.flip()) scene.colors(dice.colors(30));
    if (dice.flip()) {
      MFFloat depths;
      for (int i = dice.below(40); i > 0; --i) depths.push_back(dice.number());
      scene.property("fogCoord", "FogCoordinate", "depth", std::move(depths));
    }
  };
  const auto faces = [&](GeometryScene& scene, Dice& dice) {
    properties(scene, dice);
    if (dice.flip()) scene.texture(dice.pairs(30));
    for (const char* field : {"ccw", "solid", "normalPerVertex", "colorPerVertex"}) scene.set(field, dice.flip());
  };
  for (const char* type : {"TriangleSet", "QuadSet"}) throw_at(type, 500, faces, Language::x3d);
  for (const char* type : {"IndexedTriangleSet", "IndexedQuadSet", "IndexedTriangleFanSet", "IndexedTriangleStripSet"})
    throw_at(
        type, 500,
        [&](GeometryScene& scene, Dice& dice) {
          faces(scene, dice);
          scene.set("index", dice.indices(120, 32));
        },
        Language::x3d);
  for (const auto& [type, counts] :
       {std::pair{"TriangleFanSet", "fanCount"}, {"TriangleStripSet", "stripCount"}, {"LineSet", "vertexCount"}})
    throw_at(
        type, 500,
        [&](GeometryScene& scene, Dice& dice) {
          counts == std::string("vertexCount") ? properties(scene, dice) : faces(scene, dice);
          scene.set(counts, dice.indices(10, 12));
        },
        Language::x3d);
  throw_at("PointSet", 300, properties, Language::x3d);
}
