#include "app/formats/gltf/gltf.h"

#include "tests/app/formats_helpers.h"

#include <algorithm>
#include <optional>

namespace {

using namespace gs::test;
using gs::app::ReadFile;
using gs::vrml::Color;
using gs::vrml::MFInt32;
using gs::vrml::MFNode;
using gs::vrml::MFString;
using gs::vrml::MFVec3f;
using gs::vrml::Rotation;
using gs::vrml::SFNode;
using gs::vrml::SFVec3f;

Imported gltf(const Bytes& bytes, const ReadFile& read_file = {}) { return imported({"glTF", read_file}, bytes); }
Imported gltf(const std::string& json, const ReadFile& read_file = {}) { return gltf(bytes_of(json), read_file); }

template <class T>
Bytes bytes_of_values(std::initializer_list<T> values) {
  Bytes bytes;
  for (const T value : values) put(bytes, value);
  return bytes;
}

/// Collects data with the views and accessors that refer to them.
struct Asset {
  Bytes data;
  std::string views, accessors;
  int view_count = 0, accessor_count = 0;

  int view(const Bytes& bytes, const std::string& more = "") {
    data.resize((data.size() + 3) / 4 * 4);
    views += (view_count ? "," : "") + std::string(R"({"buffer":0,"byteOffset":)") + std::to_string(data.size()) +
             R"(,"byteLength":)" + std::to_string(bytes.size()) + more + "}";
    data.insert(data.end(), bytes.begin(), bytes.end());
    return view_count++;
  }
  int accessor(const Bytes& bytes, int component_type, int count, const std::string& type, const std::string& more = "",
               const std::string& view_more = "") {
    const int at = view(bytes, view_more);
    return accessor_text(R"("bufferView":)" + std::to_string(at) + "," + R"("componentType":)" +
                         std::to_string(component_type) + R"(,"count":)" + std::to_string(count) + R"(,"type":")" +
                         type + "\"" + more);
  }
  int accessor_text(const std::string& inside) {
    accessors += (accessor_count ? ",{" : "{") + inside + "}";
    return accessor_count++;
  }
  [[nodiscard]] std::string json(const std::string& rest, bool embedded = true) const {
    std::string text = R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":)" + std::to_string(data.size());
    if (embedded) text += R"(,"uri":"data:application/octet-stream;base64,)" + base64(data) + "\"";
    return text + "}],\"bufferViews\":[" + views + "],\"accessors\":[" + accessors + "]" + (rest.empty() ? "" : ",") +
           rest + "}";
  }
  [[nodiscard]] Bytes glb(const std::string& rest) const {
    std::string text = json(rest, false);
    text.resize((text.size() + 3) / 4 * 4, ' ');
    Bytes padded = data;
    padded.resize((padded.size() + 3) / 4 * 4);
    Bytes bytes = bytes_of("glTF");
    put(bytes, std::uint32_t{2});
    put(bytes, static_cast<std::uint32_t>(28 + text.size() + padded.size()));
    put(bytes, static_cast<std::uint32_t>(text.size()));
    put(bytes, std::uint32_t{0x4E4F534A});
    const Bytes json_bytes = bytes_of(text);
    bytes.insert(bytes.end(), json_bytes.begin(), json_bytes.end());
    put(bytes, static_cast<std::uint32_t>(padded.size()));
    put(bytes, std::uint32_t{0x004E4942});
    bytes.insert(bytes.end(), padded.begin(), padded.end());
    return bytes;
  }
};

const Bytes kCorners = bytes_of_values<float>({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0});

/// Returns a square of four corners and two triangles: accessor 0 positions, 1 indices.
Asset square_asset() {
  Asset asset;
  asset.accessor(kCorners, 5126, 4, "VEC3");
  asset.accessor(bytes_of_values<std::uint16_t>({0, 1, 2, 0, 2, 3}), 5123, 6, "SCALAR");
  return asset;
}

std::string scene_of(const std::string& primitive, const std::string& more = "") {
  return R"("scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],"meshes":[{"primitives":[{)" + primitive + "}]}]" +
         (more.empty() ? "" : ",") + more;
}

const std::string kSquarePrimitive = R"("attributes":{"POSITION":0},"indices":1)";

TEST_CASE("names what Gaussian splats of a glTF lose, once") {
  Asset asset;
  asset.accessor(kCorners, 5126, 4, "VEC3");
  asset.accessor(bytes_of_values<float>({1, 1, 0.99f, 1}), 5126, 4, "SCALAR");
  asset.accessor(bytes_of_values<float>({1, 1, 0.5f, 1}), 5126, 4, "SCALAR");
  const std::string splats = R"(,"mode":0,"extensions":{"KHR_gaussian_splatting":{"kernel":"ellipse"}})",
                    prefix = R"(,"KHR_gaussian_splatting:)";
  const std::string opaque = prefix + "OPACITY\":1", translucent = prefix + "OPACITY\":2",
                    harmonics = prefix + "SH_DEGREE_1_COEF_0\":0" + prefix + "SH_DEGREE_2_COEF_0\":0";
  const auto messages = [&](const std::string& attributes, const std::string& more) {
    const std::string primitive = R"({"attributes":{"POSITION":0)" + attributes + "}" + more + "}";
    return gltf(asset.json(R"("nodes":[{"mesh":0}],"meshes":[{"primitives":[)" + primitive + "," + primitive + "]}]"))
        .messages();
  };
  const std::string note = "test: note: splats are drawn as opaque points, without their ";
  CHECK(messages(translucent, R"(,"mode":0)").empty());
  CHECK(messages("", splats).empty());
  CHECK(messages(opaque, splats).empty());
  CHECK(messages(translucent, splats) == note + "opacity\n");
  CHECK(messages(opaque + harmonics, splats) == note + "spherical harmonics up to degree 2\n");
  CHECK(messages(translucent + harmonics, splats) == note + "opacity and spherical harmonics up to degree 2\n");
}

TEST_CASE("reads a glTF with embedded data like the same GLB") {
  const Asset asset = square_asset();
  for (const Bytes& bytes : {bytes_of(asset.json(scene_of(kSquarePrimitive))), asset.glb(scene_of(kSquarePrimitive))}) {
    const Imported result = gltf(bytes);
    CHECK(result.messages().empty());
    CHECK(result.points() == std::vector<glm::vec3>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}});
    CHECK(result.corners() == std::vector<std::int32_t>{0, 1, 2, -1, 0, 2, 3, -1});
    CHECK(result.scene->get<bool>(result.only("IndexedFaceSet"), "solid"));
    REQUIRE(result.scene->roots().size() == 1);
    CHECK(result.scene->roots()[0] == result.only("Transform"));
  }
}

TEST_CASE("reads external buffers through the callback only") {
  const Asset asset = square_asset();
  std::string json = asset.json(scene_of(kSquarePrimitive), false);
  json.replace(json.find("\"byteLength\""), 0, R"("uri":"my%20data.bin",)");
  std::vector<std::string> asked;
  const Imported result = gltf(json, [&](const std::string& name) -> gs::app::BytesResult {
    asked.push_back(name);
    return gs::app::shared_bytes(asset.data);
  });
  CHECK(result.messages().empty());
  CHECK(asked == std::vector<std::string>{"my data.bin"});
  CHECK(result.corners().size() == 8);
  CHECK(gltf(json).diagnostics.errors() == 1);
  CHECK(gltf(json, [](const std::string&) -> gs::app::BytesResult { return "it is gone"; }).diagnostics.errors() == 1);
}

TEST_CASE("converts nodes to Transforms") {
  const Asset asset = square_asset();
  const Imported result = gltf(asset.json(
      R"("scene":0,"scenes":[{"nodes":[0]}],"nodes":[)"
      R"({"name":"top","children":[1,2,3],"translation":[1,2,3],"scale":[2,2,2],"rotation":[0,0.70710678,0,0.70710678]},)"
      R"({"name":"1 arm","mesh":0,"matrix":[0,2,0,0,-2,0,0,0,0,0,2,0,5,6,7,1]},{"name":"1 arm","mesh":0},{"name":"empty"}],)"
      R"("meshes":[{"name":"m","primitives":[{"attributes":{"POSITION":0},"indices":1}]}])"));
  CHECK(result.messages().empty());
  const auto transforms = result.all("Transform");
  REQUIRE(transforms.size() == 3);
  const auto top = result.scene->roots()[0];
  CHECK(result.scene->node(top).name == "top");
  CHECK(result.scene->get<SFVec3f>(top, "translation") == glm::vec3(1, 2, 3));
  CHECK(result.scene->get<SFVec3f>(top, "scale") == glm::vec3(2, 2, 2));
  const auto turn = result.scene->get<Rotation>(top, "rotation");
  CHECK(turn.y == Approx(1));
  CHECK(turn.angle == Approx(1.5707963));
  const auto children = result.values<MFNode>(top, "children");
  REQUIRE(children.size() == 2);
  CHECK(result.scene->node(children[0]).name == "_1_arm");
  CHECK(result.scene->node(children[1]).name.starts_with("_1_arm_"));
  const auto matrix = result.scene->get<Rotation>(children[0], "rotation");
  CHECK(matrix.z == Approx(1));
  CHECK(matrix.angle == Approx(1.5707963));
  CHECK(result.scene->get<SFVec3f>(children[0], "scale").x == Approx(2));
  CHECK(result.scene->get<SFVec3f>(children[0], "translation") == glm::vec3(5, 6, 7));
  // One mesh is one Shape at two instances.
  CHECK(result.all("Shape").size() == 1);
  CHECK(result.values<MFNode>(children[0], "children") == result.values<MFNode>(children[1], "children"));
}

TEST_CASE("reads all modes of primitives") {
  Asset asset = square_asset();
  const auto indices = [&](int mode) {
    const Imported result = gltf(asset.json(scene_of(R"("attributes":{"POSITION":0},"mode":)" + std::to_string(mode))));
    CHECK(result.messages().empty());
    if (mode == 0)
      return result.values<MFVec3f>(result.only("Coordinate"), "point").size() == 4 && result.only("PointSet")
                 ? std::vector<std::int32_t>{4}
                 : std::vector<std::int32_t>{};
    return result.values<MFInt32>(result.only(mode < 4 ? "IndexedLineSet" : "IndexedFaceSet"), "coordIndex");
  };
  using Index = std::vector<std::int32_t>;
  CHECK(indices(0) == Index{4});
  CHECK(indices(1) == Index{0, 1, -1, 2, 3, -1});
  CHECK(indices(2) == Index{0, 1, 2, 3, 0, -1});
  CHECK(indices(3) == Index{0, 1, 2, 3, -1});
  CHECK(indices(4) == Index{0, 1, 2, -1});
  CHECK(indices(5) == Index{0, 1, 2, -1, 1, 3, 2, -1});
  CHECK(indices(6) == Index{1, 2, 0, -1, 2, 3, 0, -1});
  CHECK(gltf(asset.json(scene_of(R"("attributes":{"POSITION":0},"mode":7)"))).diagnostics.errors() == 1);
}

TEST_CASE("reads normalised, strided and sparse accessors") {
  Asset asset = square_asset();
  // Byte colours with alpha, at a stride of eight bytes.
  const int colors =
      asset.accessor(bytes_of_values<std::uint8_t>({255, 0, 0, 255, 9,   9,   9, 9, 0, 255, 0,   0,   9,   9,
                                                    9,   9, 0, 0,   255, 255, 9, 9, 9, 9,   255, 255, 255, 255}),
                     5121, 4, "VEC4", R"(,"normalized":true)", R"(,"byteStride":8)");
  const int where = asset.view(bytes_of_values<std::uint8_t>({1, 3}));
  const int what = asset.view(bytes_of_values<float>({7, 8, 9, 10, 11, 12}));
  const std::string sparse = R"("sparse":{"count":2,"indices":{"bufferView":)" + std::to_string(where) +
                             R"(,"componentType":5121},"values":{"bufferView":)" + std::to_string(what) + "}}";
  const int moved = asset.accessor_text(R"("bufferView":0,"componentType":5126,"count":4,"type":"VEC3",)" + sparse);
  const int zeros = asset.accessor_text(R"("componentType":5126,"count":4,"type":"VEC3",)" + sparse);

  const auto with = [&](int positions) {
    return gltf(asset.json(scene_of(R"("attributes":{"POSITION":)" + std::to_string(positions) + R"(,"COLOR_0":)" +
                                    std::to_string(colors) + R"(},"indices":1)")));
  };
  const Imported result = with(moved);
  CHECK(result.messages().empty());
  CHECK(result.points() == std::vector<glm::vec3>{{0, 0, 0}, {7, 8, 9}, {1, 1, 0}, {10, 11, 12}});
  CHECK(result.colors() == std::vector<Color>{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}});
  CHECK(with(zeros).points() == std::vector<glm::vec3>{{0, 0, 0}, {7, 8, 9}, {0, 0, 0}, {10, 11, 12}});

  // Signed normalised shorts as in KHR_mesh_quantization.
  const int shorts = asset.accessor(bytes_of_values<std::int16_t>({32767, -32767, -32768, 0, 0, 0, 16384, 0, 0, 0}),
                                    5122, 3, "VEC3", R"(,"normalized":true)");
  const auto points =
      gltf(asset.json(scene_of(R"("attributes":{"POSITION":)" + std::to_string(shorts) + "}"))).points();
  REQUIRE(points.size() == 3);
  CHECK(points[0] == glm::vec3(1, -1, -1));
  CHECK(points[2].x == Approx(16384.0 / 32767));
}

TEST_CASE("converts materials to the nearest ones of VRML97") {
  Asset asset = square_asset();
  const std::string primitive = kSquarePrimitive + R"(,"material":0)";
  const auto with = [&](const std::string& material) {
    return gltf(asset.json(scene_of(primitive, R"("materials":[{)" + material + "}]")));
  };
  Imported result = with(
      R"("name":"paint","doubleSided":true,"alphaMode":"BLEND","emissiveFactor":[0,0,1],)"
      R"("pbrMetallicRoughness":{"baseColorFactor":[1,0.21404114,0,0.25],"metallicFactor":0,"roughnessFactor":0.5})");
  CHECK(result.messages().empty());
  auto material = result.only("Material");
  const auto diffuse = result.scene->get<Color>(material, "diffuseColor");
  CHECK(diffuse.r == 1);
  CHECK(diffuse.g == Approx(0.5).margin(1e-4));  // linear 0.214 displays as half
  CHECK(result.scene->get<float>(material, "transparency") == 0.75f);
  CHECK(result.scene->get<Color>(material, "emissiveColor") == Color{0, 0, 1});
  const auto specular = result.scene->get<Color>(material, "specularColor");
  CHECK(specular.r > 0);
  CHECK(specular.r == specular.b);
  CHECK_FALSE(result.scene->get<bool>(result.only("IndexedFaceSet"), "solid"));
  CHECK(result.scene->node(result.only("Appearance")).name == "paint");

  result = with(R"("pbrMetallicRoughness":{"baseColorFactor":[1,0,0,0.25],"metallicFactor":1,"roughnessFactor":0})");
  material = result.only("Material");
  CHECK(result.scene->get<Color>(material, "specularColor") == Color{1, 0, 0});
  CHECK(result.scene->get<float>(material, "transparency") == 0);
  result = with(R"("alphaMode":"MASK","pbrMetallicRoughness":{"baseColorFactor":[1,1,1,0.25]})");
  CHECK(result.scene->get<float>(result.only("Material"), "transparency") == 1);
  result = with(R"("extensions":{"KHR_materials_unlit":{}},"pbrMetallicRoughness":{"baseColorFactor":[1,0,0,1]})");
  CHECK(result.scene->get<Color>(result.only("Material"), "emissiveColor") == Color{1, 0, 0});
}

TEST_CASE("reads textures by name, from a data URL and from a buffer") {
  Asset asset = square_asset();
  const int uv = asset.accessor(bytes_of_values<float>({0, 0, 1, 0, 1, 0.25f, 0, 1}), 5126, 4, "VEC2");
  const int picture = asset.view(bytes_of("\x89PNG"));
  const std::string primitive =
      R"("attributes":{"POSITION":0,"TEXCOORD_0":)" + std::to_string(uv) + R"(},"indices":1,"material":0)";
  const auto with = [&](const std::string& image, const std::string& info = "") {
    return gltf(asset.json(scene_of(
        primitive, R"("materials":[{"pbrMetallicRoughness":{"baseColorTexture":{"index":0)" + info +
                       R"(}}}],"textures":[{"source":0,"sampler":0}],"samplers":[{"wrapS":33071}],"images":[{)" +
                       image + "}]")));
  };
  const auto url = [](const Imported& result) {
    return result.scene->get<MFString>(result.only("ImageTexture"), "url")[0].str();
  };
  const Imported named = with(R"("uri":"tex/my%20wood.png")");
  CHECK(named.messages().empty());
  CHECK(url(named) == "tex/my%20wood.png");
  CHECK_FALSE(named.scene->get<bool>(named.only("ImageTexture"), "repeatS"));
  CHECK(named.scene->get<bool>(named.only("ImageTexture"), "repeatT"));
  // In VRML97, t increases from the bottom.
  CHECK(named.values<gs::vrml::MFVec2f>(named.only("TextureCoordinate"), "point") ==
        std::vector<glm::vec2>{{0, 1}, {1, 1}, {1, 0.75f}, {0, 0}});
  CHECK(url(with(R"("uri":"data:image/png;base64,iVBORw==")")) == "data:image/png;base64,iVBORw==");
  CHECK(url(with(R"("mimeType":"image/png","bufferView":)" + std::to_string(picture))) ==
        "data:image/png;base64,iVBORw==");
  CHECK(url(with(R"("bufferView":)" + std::to_string(picture))) == "data:image/png;base64,iVBORw==");
  const Imported moved =
      with(R"("uri":"a.png")", R"(,"extensions":{"KHR_texture_transform":{"offset":[0.5,0.25],"scale":[2,4]}})");
  CHECK(moved.values<gs::vrml::MFVec2f>(moved.only("TextureCoordinate"), "point")[2] == glm::vec2(2.5f, 1 - 1.25f));
  CHECK(with(R"("bufferView":99)").diagnostics.errors() == 1);
}

TEST_CASE("keeps materials and maps of glTF as PhysicalMaterials in X3D worlds (X3D 12.4.6)") {
  Asset asset = square_asset();
  const int uv = asset.accessor(bytes_of_values<float>({0, 0, 1, 0, 1, 0.25f, 0, 1}), 5126, 4, "VEC2");
  const std::string primitive =
      R"("attributes":{"POSITION":0,"TEXCOORD_0":)" + std::to_string(uv) + R"(},"indices":1,"material":0)";
  const auto with = [&](const std::string& material) {
    Import import("glTF");
    import.for_x3d = true;
    return imported(import,
                    bytes_of(asset.json(scene_of(primitive, R"("materials":[{)" + material +
                                                                R"(}],"textures":[{"source":0},{"source":1}],)"
                                                                R"("images":[{"uri":"a.png"},{"uri":"b.png"}])"))));
  };
  const Imported result = with(
      R"("pbrMetallicRoughness":{"baseColorFactor":[1,0.2140411,0,0.25],"metallicFactor":0.5,"roughnessFactor":0.75,)"
      R"("metallicRoughnessTexture":{"index":1}},"normalTexture":{"index":0,"scale":2},)"
      R"("occlusionTexture":{"index":1,"strength":0.5},"emissiveTexture":{"index":0,"texCoord":1},)"
      R"("emissiveFactor":[0,0,1],"alphaMode":"MASK","alphaCutoff":0.25)");
  CHECK(result.diagnostics.errors() == 0);
  CHECK(result.messages().find("the emissiveTexture with texture coordinates of its own is left out") !=
        std::string::npos);
  CHECK(result.all("Material").empty());
  const auto material = result.only("PhysicalMaterial");
  const gs::vrml::SceneGraph& scene = *result.scene;
  CHECK(scene.get<Color>(material, "baseColor").g == Approx(0.5).margin(1e-4));
  CHECK(scene.get<Color>(material, "emissiveColor") == Color{0, 0, 1});
  CHECK(scene.get<float>(material, "metallic") == 0.5f);
  CHECK(scene.get<float>(material, "roughness") == 0.75f);
  CHECK(scene.get<float>(material, "normalScale") == 2);
  CHECK(scene.get<float>(material, "occlusionStrength") == 0.5f);
  CHECK(scene.get<float>(material, "transparency") == 0.75f);
  const auto url = [&](const char* field) {
    const auto texture = scene.get<SFNode>(material, field);
    return texture ? scene.get<MFString>(texture, "url")[0].str() : "";
  };
  CHECK(url("baseTexture").empty());
  CHECK(url("normalTexture") == "a.png");
  CHECK(url("metallicRoughnessTexture") == "b.png");
  CHECK(url("occlusionTexture") == "b.png");
  CHECK(url("emissiveTexture").empty());
  const auto appearance = result.only("Appearance");
  CHECK(scene.get<gs::vrml::SFString>(appearance, "alphaMode").str() == "MASK");
  CHECK(scene.get<float>(appearance, "alphaCutoff") == 0.25f);
  CHECK(result.values<gs::vrml::MFVec2f>(result.only("TextureCoordinate"), "point").size() == 4);
  CHECK(with(R"("extensions":{"KHR_materials_unlit":{}})").all("PhysicalMaterial").empty());
}

TEST_CASE("converts cameras to Viewpoints") {
  const Imported result = gltf(
      R"({"asset":{"version":"2.0"},"nodes":[{"camera":0,"translation":[0,0,5]},{"camera":1},{"camera":2},{"camera":9}],)"
      R"("cameras":[{"name":"Front","type":"perspective","perspective":{"yfov":1,"znear":0.1,"aspectRatio":2}},)"
      R"({"type":"perspective","perspective":{"yfov":1.5707963,"znear":0.1,"aspectRatio":0.5}},)"
      R"({"type":"orthographic","orthographic":{"xmag":1,"ymag":1,"znear":0,"zfar":1}}]})");
  const auto views = result.all("Viewpoint");
  REQUIRE(views.size() == 2);
  std::vector<float> fields = {result.scene->get<float>(views[0], "fieldOfView"),
                               result.scene->get<float>(views[1], "fieldOfView")};
  std::sort(fields.begin(), fields.end());
  CHECK(fields[0] == Approx(2 * std::atan(0.5)));
  CHECK(fields[1] == Approx(1));
  CHECK(result.scene->get<SFVec3f>(views[0], "position") == glm::vec3(0));
  CHECK(result.diagnostics.errors() == 1);
}

TEST_CASE("places a skinned mesh by its joints") {
  Asset asset = square_asset();
  const int joints =
      asset.accessor(bytes_of_values<std::uint8_t>({0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0}), 5121, 4, "VEC4");
  const int weights =
      asset.accessor(bytes_of_values<float>({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0.5f, 0.5f, 0, 0}), 5126, 4, "VEC4");
  Bytes matrices;
  for (int m = 0; m < 2; ++m)
    for (int i = 0; i < 16; ++i) put(matrices, i % 5 == 0 ? 1.0f : (m == 1 && i == 12 ? -1.0f : 0.0f));
  const int inverse = asset.accessor(matrices, 5126, 2, "MAT4");
  const Imported result = gltf(asset.json(
      R"("scenes":[{"nodes":[0,1]}],"nodes":[{"mesh":0,"skin":0,"translation":[100,0,0]},)"
      R"({"translation":[0,0,3],"children":[2]},{"translation":[1,0,4]}],"skins":[{"joints":[1,2],"inverseBindMatrices":)" +
      std::to_string(inverse) + R"(}],"meshes":[{"primitives":[{"attributes":{"POSITION":0,"JOINTS_0":)" +
      std::to_string(joints) + R"(,"WEIGHTS_0":)" + std::to_string(weights) + R"(},"indices":1}]}])"));
  CHECK(result.messages().empty());
  // Joint 0 moves by (0,0,3); joint 1, bound at x = 1, by (0,0,7).
  CHECK(result.points() == std::vector<glm::vec3>{{0, 0, 3}, {1, 0, 3}, {1, 1, 7}, {0, 1, 5}});
  REQUIRE(result.scene->roots().size() == 1);
  CHECK(result.scene->roots()[0] == result.only("Shape"));
}

TEST_CASE("reports Draco as an error of its primitive only") {
  const Asset asset = square_asset();
  const std::string rest =
      R"("extensionsUsed":["KHR_draco_mesh_compression"],"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],)"
      R"("meshes":[{"name":"m","primitives":[{"attributes":{"POSITION":0},"indices":1},{"attributes":{"POSITION":2},)"
      R"("indices":3,"extensions":{"KHR_draco_mesh_compression":{"bufferView":0,"attributes":{"POSITION":0}}}}]}])";
  Asset more = asset;
  more.accessor_text(R"("componentType":5126,"count":24,"type":"VEC3")");
  more.accessor_text(R"("componentType":5123,"count":36,"type":"SCALAR")");
  for (const Bytes& bytes : {bytes_of(more.json(rest)), more.glb(rest)}) {
    const Imported result = gltf(bytes);
    CHECK(result.corners().size() == 8);
    CHECK(result.messages() ==
          "test: error: mesh 0 (m), primitive 1: KHR_draco_mesh_compression is not supported; the primitive is left "
          "out\n");
  }
}

TEST_CASE("reports data beyond a buffer as an error of its primitive") {
  const auto with = [](const std::string& accessor, const std::string& primitive) {
    Asset asset = square_asset();
    asset.accessor_text(accessor);
    Imported result = gltf(asset.json(scene_of(primitive)));
    check_sound(result);
    return result;
  };
  const std::string position = R"("attributes":{"POSITION":2})";
  for (
      const char* accessor :
      {R"("bufferView":0,"componentType":5126,"count":5,"type":"VEC3")",
       R"("bufferView":0,"componentType":5126,"count":18446744073709551615,"type":"VEC3")",
       R"("bufferView":0,"componentType":5126,"count":4,"type":"VEC3","byteOffset":18446744073709551000)",
       R"("bufferView":0,"componentType":5126,"count":4,"type":"VEC3","byteOffset":4)",
       R"("bufferView":0,"componentType":5131,"count":1,"type":"VEC3")",
       R"("bufferView":0,"componentType":5126,"count":4,"type":"VEC2")",
       R"("bufferView":7,"componentType":5126,"count":4,"type":"VEC3")",
       R"("componentType":5126,"count":2000000000,"type":"VEC3")",
       R"("bufferView":0,"componentType":5126,"count":4,"type":"VEC3","sparse":{"count":9,"indices":{"bufferView":1,"componentType":5121},"values":{"bufferView":0}})",
       R"("bufferView":0,"componentType":5126,"count":4,"type":"VEC3","sparse":{"count":4,"indices":{"bufferView":0,"componentType":5125},"values":{"bufferView":0}})"}) {
    const Imported result = with(accessor, position);
    INFO(accessor);
    CHECK(result.diagnostics.errors() == 1);
    CHECK(result.all("Shape").empty());
  }
  const Imported index = with(R"("bufferView":0,"componentType":5126,"count":4,"type":"VEC3")",
                              R"("attributes":{"POSITION":0},"indices":2)");
  CHECK(index.diagnostics.errors() == 1);
  CHECK(with(R"("x":1,"componentType":5126,"count":1,"type":"VEC3")", R"("attributes":{"POSITION":-7})")
            .diagnostics.errors() == 1);
}

TEST_CASE("cuts cyclic node trees, and limits their depth") {
  const Asset asset = square_asset();
  const std::string mesh = R"("meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}])";
  const Imported loop = gltf(asset.json(
      R"("scenes":[{"nodes":[0,0,9]}],"nodes":[{"children":[1,1,-3]},{"mesh":0,"children":[0,1]}],)" + mesh));
  CHECK(loop.diagnostics.errors() == 6);
  CHECK(loop.all("Transform").size() == 2);

  std::string nodes;
  constexpr int kDepth = 5000;
  for (int i = 0; i < kDepth; ++i) nodes += R"({"mesh":0,"children":[)" + std::to_string(i + 1) + "]},";
  const Imported deep = gltf(asset.json(R"("scenes":[{"nodes":[0]}],"nodes":[)" + nodes + R"({"mesh":0}],)" + mesh));
  CHECK(deep.diagnostics.errors() == 1);
  CHECK(deep.all("Transform").size() == deep.scene->limits().nesting);
}

TEST_CASE("refuses hostile JSON before tinygltf reads it") {
  const std::string deep = R"({"asset":{"version":"2.0"},"extras":)" + std::string(100'000, '[');
  CHECK(gltf(deep).messages() == "test: error: glTF: nested deeper than 200 levels\n");
  std::string many = R"({"asset":{"version":"2.0"},"materials":[)";
  for (int i = 0; i < 1'000'001; ++i) many += "{},";
  CHECK(gltf(many + "{}]}").messages().find("values take more than the limit for files in memory") !=
        std::string::npos);
  CHECK(gltf(std::string("{")).messages() == "test: error: glTF: expected a JSON object, as glTF 2.0 describes it\n");
  CHECK(gltf(Bytes{}).diagnostics.errors() == 1);
  CHECK(gltf(std::string(R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":1}]})")).messages() ==
        "test: error: glTF: buffer 0 has no uri\n");
  CHECK(gltf(bytes_of("glTF\x01")).diagnostics.errors() == 1);
  CHECK(gltf(std::string(R"({"asset":{"version":"2.0"},"extensionsRequired":["EXT_x"]})")).diagnostics.errors() == 1);
}

TEST_CASE("refuses data that are referenced very often") {
  Asset asset;
  Bytes corners;
  for (int i = 0; i < 30'000; ++i) put(corners, float{1});
  asset.accessor(corners, 5126, 10'000, "VEC3");
  std::string primitives;
  for (int i = 0; i < 2000; ++i) primitives += R"({"attributes":{"POSITION":0}},)";
  const Imported result = gltf(asset.glb(R"("nodes":[{"mesh":0}],"meshes":[{"primitives":[)" + primitives +
                                         R"({"attributes":{"POSITION":0}}]}])"));
  CHECK(result.diagnostics.errors() > 100);
  CHECK(result.messages().find("the asset refers to its data too many times") != std::string::npos);
  CHECK(result.all("Shape").size() > 100);
}

TEST_CASE("survives every truncation and every changed byte of a glTF") {
  Asset asset = square_asset();
  const std::string rest = scene_of(
      R"("attributes":{"POSITION":0},"indices":1,"material":0)",
      R"("materials":[{"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}],"textures":[{"source":0}],"images":[{"bufferView":1,"mimeType":"image/png"}])");
  check_prefixes_and_flips("glTF", asset.glb(rest));
  check_prefixes_and_flips("glTF", bytes_of(asset.json(rest)));
}

}  // namespace
