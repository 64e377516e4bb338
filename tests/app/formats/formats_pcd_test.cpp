#include "app/formats/common/asset.h"
#include "app/formats/mesh/pcd_cloud.h"
#include "app/formats/mesh/points.h"
#include "tests/app/formats_helpers.h"
#include "tests/app/shared_facts.h"

using namespace gs;
using namespace gs::app;
using namespace gs::test;

namespace {

std::string pcd_head(const std::string& fields, const std::string& types, std::size_t count, std::size_t rows,
                     const std::string& data, const std::string& viewpoint = "0 0 0 1 0 0 0") {
  std::string sizes, counts;
  for (std::size_t i = 0; i < count; ++i) {
    sizes += " 4";
    counts += " 1";
  }
  return "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS " + fields + "\nSIZE" + sizes + "\nTYPE " +
         types + "\nCOUNT" + counts + "\nWIDTH " + std::to_string(rows) + "\nHEIGHT 1\nVIEWPOINT " + viewpoint +
         "\nPOINTS " + std::to_string(rows) + "\nDATA " + data + "\n";
}

float packed_color(std::uint32_t r, std::uint32_t g, std::uint32_t b) {
  return std::bit_cast<float>(r << 16 | g << 8 | b);
}

}  // namespace

TEST_CASE("reads points and packed colours of PCD as bytes, and leaves out points without a position") {
  Bytes file = bytes_of(pcd_head("x y z rgb", "F F F F", 4, 3, "binary"));
  for (int i = 0; i < 3; ++i) {
    put(file, i == 1 ? NAN : static_cast<float>(i));
    put(file, 2.0f);
    put(file, 3.0f);
    put(file, packed_color(255, 0, static_cast<std::uint32_t>(i)));
  }
  const Imported result = imported("PCD", file);
  CHECK(result.points() == std::vector<glm::vec3>{{0, 2, 3}, {2, 2, 3}});
  REQUIRE(result.colors().size() == 2);
  CHECK(result.colors()[1].r == 1);
  CHECK(result.colors()[1].b == Approx(2.0 / 255));
  CHECK_THAT(result.messages(), Catch::Contains("1 points without a position"));
  // A truncated file gives the points that it has.
  Bytes cut = file;
  cut.resize(cut.size() - 5);
  const Imported part = imported("PCD", cut);
  CHECK(part.points().size() == 1);
  CHECK_THAT(part.messages(), Catch::Contains("after 2 points; expected 3"));
}

TEST_CASE("reads PCD as text, with intensities and the pose of the sensor") {
  const Imported result = imported(
      "PCD", bytes_of(pcd_head("x y z intensity", "F F F F", 4, 2, "ascii", "10 0 0 0.70710678 0 0 0.70710678") +
                      "1 0 0 5\n0 1 0 9\n"));
  REQUIRE(result.points().size() == 2);
  CHECK(result.points()[0].x == Approx(10));
  CHECK(result.points()[0].y == Approx(1));
  CHECK(result.points()[1].x == Approx(9));
  REQUIRE(color_key_of(*result.scene));
  CHECK(color_key_of(*result.scene)->title == "intensity");
  CHECK(color_key_of(*result.scene)->high == 9);
}

TEST_CASE("reads compressed PCD, which stores each field contiguously") {
  Bytes columns;
  for (const float x : {1.0f, 2.0f, 3.0f, 4.0f}) put(columns, x);
  for (int i = 0; i < 8; ++i) put(columns, 7.0f);
  Bytes packed;
  // The x as they are, one 7, and a repetition of it.
  packed.push_back(std::byte{19});
  packed.insert(packed.end(), columns.begin(), columns.begin() + 20);
  packed.push_back(std::byte{7 << 5});
  packed.push_back(std::byte{28 - 9});
  packed.push_back(std::byte{3});
  Bytes file = bytes_of(pcd_head("x y z", "F F F", 3, 4, "binary_compressed"));
  put(file, static_cast<std::uint32_t>(packed.size()));
  put(file, static_cast<std::uint32_t>(columns.size()));
  file.insert(file.end(), packed.begin(), packed.end());
  CHECK(imported("PCD", file).points() == std::vector<glm::vec3>{{1, 7, 7}, {2, 7, 7}, {3, 7, 7}, {4, 7, 7}});
  for (std::size_t i = 0; i < file.size(); i += watched_step(5)) {
    Bytes damaged = file;
    damaged[i] ^= std::byte{0x40};
    (void)imported("PCD", damaged);
    (void)imported("PCD", Bytes(file.begin(), file.begin() + static_cast<std::ptrdiff_t>(i)));
  }
}

TEST_CASE("turns clouds of cameras upright, and reads normals as vectors") {
  std::string image = pcd_head("x y z", "F F F", 3, 4, "ascii");
  image.replace(image.find("WIDTH 4\nHEIGHT 1"), 16, "WIDTH 2\nHEIGHT 2");
  const Imported upright = imported("PCD", bytes_of(image + "1 2 3 1 2 3 1 2 3 1 2 3"));
  CHECK(upright.points()[0] == glm::vec3(1, -2, -3));
  const Bytes normals = bytes_of(pcd_head("x y z normal_x normal_y normal_z", "F F F F F F", 6, 2, "ascii") +
                                 "0 0 0 0 0 2\n1 0 0 0 1 0\n");
  CHECK(content_type_by_mark(normals)->name == "points PCD");
  const ImportedVectors vectors = import_points_pcd(normals);
  REQUIRE(std::holds_alternative<qnv::Splats>(vectors));
  CHECK(std::get<qnv::Splats>(vectors).size() == 2);
  CHECK(std::get<qnv::Splats>(vectors).normals[0] == glm::vec3(0, 0, 1));
}

TEST_CASE("reads all points of a PCD file of another program") {
  const std::string folder = shared_data("meshes");
  if (folder.empty()) return;
  const Imported cloud = imported("PCD", file_bytes(folder + "points/region_growing_rgb_tutorial.pcd"));
  CHECK(cloud.points().size() > 250'000);
  CHECK(cloud.colors().size() == cloud.points().size());
}
