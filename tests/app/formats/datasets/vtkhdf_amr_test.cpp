#include "qnv/sampling/volume/volume_slices.h"
#include "tests/app/formats/datasets/dataset_helpers.h"

using namespace gs;
using namespace gs::app;
using namespace gs::test;

namespace {

constexpr const char* kAmrScript = R"(
def write_level(f, number, spacing, boxes, value, broken=False):
    g = f.create_group('VTKHDF/Level%d' % number)
    g.attrs['Spacing'] = np.array(spacing, 'f8')
    g['AMRBox'] = np.array(boxes, 'i4')
    cells = [np.full(((b[1]-b[0]+1) * (b[3]-b[2]+1) * (b[5]-b[4]+1),), value + i, 'f4') for i, b in enumerate(boxes)]
    g['CellData/rho'] = np.concatenate(cells)[1 if broken else 0:]

def write(name, broken=False):
    with h5py.File(name, 'w') as f:
        r = f.create_group('VTKHDF')
        r.attrs['Version'] = (2, 0)
        r.attrs['Type'] = np.bytes_('OverlappingAMR')
        r.attrs['GridDescription'] = np.bytes_('XYZ')
        r.attrs['Origin'] = np.array([-1., 0, 10])
        write_level(f, 0, (1, 1, 1), [(0, 3, 0, 3, 0, 1), (0, 3, 0, 3, 2, 3)], 1)
        write_level(f, 1, (.5, .5, .5), [(2, 5, 2, 5, 2, 3)], 10, broken)
write('amr.vtkhdf')
write('broken.vtkhdf', True)
)";

}  // namespace

TEST_CASE("joins the levels of an OverlappingAMR, the finest of each place") {
  const ScratchFolder folder;
  if (!run_python(folder, kAmrScript)) return;
  DatasetSample sample(file_bytes(folder.path("amr.vtkhdf")), "amr.vtkhdf");
  const qnv::VolumeSource volume = sample.opened();
  CHECK(volume.layout.dimensions == std::array<std::uint32_t, 3>{8, 8, 8});
  CHECK(volume.layout.axes[0].x == 0.5f);
  CHECK((volume.layout.base + volume.layout.origin) == glm::dvec3(-0.75, 0.25, 10.25));
  std::vector<std::byte> scratch;
  std::vector<float> slice(64);
  REQUIRE(qnv::read_slice(volume, 3, scratch, slice));
  CHECK(slice[0] == 1);           // the first box of level 0
  CHECK(slice[2 * 8 + 2] == 10);  // level 1
  CHECK(slice[5 * 8 + 5] == 10);
  CHECK(slice[6 * 8 + 5] == 1);
  REQUIRE(qnv::read_slice(volume, 4, scratch, slice));
  CHECK(slice[2 * 8 + 2] == 2);  // the second box of level 0
  const auto entries = sample.entries();
  const auto found = std::ranges::find(entries, "/VTKHDF/Level0/CellData/rho", &DatasetEntry::path);
  REQUIRE(found != entries.end());
  CHECK(found->note == "data of cells of 2 levels");
  CHECK(std::ranges::any_of(volume.layout.metadata, [](const auto& pair) {
    return pair.first == "level of the voxels" && pair.second == "1";
  }));
}

TEST_CASE("leaves out levels of an OverlappingAMR with more cells than values") {
  const ScratchFolder folder;
  if (!run_python(folder, kAmrScript)) return;
  DatasetSample sample(file_bytes(folder.path("broken.vtkhdf")), "broken.vtkhdf");
  const qnv::VolumeSource volume = sample.opened();
  CHECK(volume.layout.dimensions == std::array<std::uint32_t, 3>{4, 4, 4});
  CHECK(std::ranges::any_of(volume.layout.metadata, [](const auto& pair) {
    return pair.first == "levels left out" && pair.second.find("more cells than values") != std::string::npos;
  }));
}
