#include "qnv/sampling/volume/volume_slices.h"
#include "tests/app/formats/datasets/dataset_helpers.h"

using namespace gs;
using namespace gs::app;
using namespace gs::test;

namespace {

Bytes xdmf_with(const std::string& grids) {
  return bytes_of("<?xml version='1.0'?>\n<Xdmf Version='3.0'><Domain>" + grids + "</Domain></Xdmf>");
}

constexpr const char* kPoints =
    "<Geometry GeometryType='XYZ'><DataItem Format='XML'>0 0 0  1 0 0  0 1 0  0 0 1</DataItem></Geometry>";

std::size_t faces_of(const MeshAsset& mesh) {
  std::size_t faces = 0;
  for (const MeshPart& part : mesh.parts)
    faces += static_cast<std::size_t>(std::ranges::count(std::span(part.geometry.coord_index), -1));
  return faces;
}

}  // namespace

TEST_CASE("reads uniform and mixed topologies of XDMF") {
  DatasetSample tetrahedron(
      xdmf_with("<Grid Name='a'><Topology TopologyType='Tetrahedron'><DataItem Format='XML'>0 1 2 3"
                "</DataItem></Topology>" +
                std::string(kPoints) + "</Grid>"));
  CHECK(faces_of(tetrahedron.mesh()) == 4);
  DatasetSample mixed(
      xdmf_with("<Grid Name='a'><Topology TopologyType='Mixed'><DataItem Format='XML'>4 0 1 2  3 3 1 2 3"
                "</DataItem></Topology>" +
                std::string(kPoints) + "</Grid>"));
  CHECK(faces_of(mixed.mesh()) == 2);
}

TEST_CASE("shows the chosen step of a temporal collection of XDMF") {
  std::string grids = "<Grid GridType='Collection' CollectionType='Temporal'>";
  for (int i = 0; i < 3; ++i)
    grids += "<Grid Name='a'><Time Value='" + std::to_string(i * 0.5) +
             "'/><Topology TopologyType='Triangle'><DataItem Format='XML'>0 1 2"
             "</DataItem></Topology>" +
             std::string(kPoints) + "<Attribute Name='p' Center='Cell'><DataItem Format='XML' Dimensions='1'>" +
             std::to_string(i) + "</DataItem></Attribute></Grid>";
  VoxelComponent choice;
  choice.step = qnv::ShownStep{0, 1.0};
  DatasetSample sample(xdmf_with(grids + "</Grid>"), "a.xdmf", choice);
  const MeshAsset mesh = sample.mesh();
  REQUIRE(mesh.color_key);
  CHECK(mesh.color_key->title == "p");
  CHECK(mesh.color_key->low == 2);
}

TEST_CASE("reads regular grids of XDMF as volumes of another file") {
  const Bytes seed = file_bytes(std::string(GHOSTSPACE_TESTS "/fuzz/corpus/app/xdmf/regular.xdmf"));
  const std::string text = std::string(reinterpret_cast<const char*>(seed.data()), seed.size());
  const std::string mark = "\n==== the other file\n";
  const std::size_t at = text.find(mark);
  REQUIRE(at != std::string::npos);
  DatasetSample sample(bytes_of(text.substr(0, at)), "a.xdmf");
  sample.read_file = [&](const std::string& name) -> BytesResult {
    if (name != "volume.img") return "there is no " + name;
    return shared_bytes(bytes_of(text.substr(at + mark.size())));
  };
  const qnv::VolumeSource volume = sample.opened();
  CHECK(volume.layout.dimensions == std::array<std::uint32_t, 3>{6, 5, 4});
  CHECK(volume.layout.axes[2] == glm::vec3(0, 0, 2));
  CHECK(facts_of(volume).most == 16);
}

TEST_CASE("damaged XDMF files give one message") {
  const std::pair<const char*, const char*> samples[] = {
      {"<Xdmf><Domain>", "line 1: "},
      {"<Xdmf></Xdmf>", "it has no Domain"},
      {"<Xdmf><Domain></Domain></Xdmf>", "it has no Grid with Topology and Geometry"},
      {"<?xml version='1.0'?><!DOCTYPE Xdmf [<!ENTITY a 'aaaaaaaaaa'><!ENTITY b '&a;&a;&a;&a;'>]><Xdmf>&b;</Xdmf>",
       "it has no Domain"},
  };
  for (const auto& [text, expected] : samples)
    CHECK_THAT(DatasetSample(bytes_of(text), "a.xdmf").problem(), Catch::StartsWith(expected));
}
