#include "app/formats/datasets/arrays/classic_netcdf.h"
#include "qnv/sampling/volume/volume_slices.h"
#include "tests/app/formats/datasets/dataset_helpers.h"

using namespace gs;
using namespace gs::app;
using namespace gs::test;

namespace {

Bytes netcdf_seed(const std::string& name) {
  return file_bytes(std::string(GHOSTSPACE_TESTS "/fuzz/corpus/app/netcdf/") + name);
}

std::string metadata_value(const qnv::VolumeSource& volume, std::string_view key) {
  for (const auto& [name, value] : volume.layout.metadata)
    if (name == key) return value;
  return {};
}

}  // namespace

TEST_CASE("reads the three classic formats of NetCDF alike") {
  for (const char* const name : {"cdf1.nc", "cdf2.nc", "cdf5.nc"}) {
    INFO(name);
    const Bytes bytes = netcdf_seed(name);
    REQUIRE(is_classic_netcdf(bytes));
    DatasetSample sample(bytes, name);
    const auto entries = sample.entries();
    REQUIRE(entries.size() == 5);
    const auto entry = std::ranges::find(entries, std::string("/v"), &DatasetEntry::path);
    REQUIRE(entry != entries.end());
    CHECK(entry->shape == std::vector<std::uint64_t>{2, 3, 4, 5});
    CHECK(entry->axes == "time, lev, lat, lon");
    const qnv::VolumeSource volume = sample.opened();
    CHECK(volume.times == std::vector<double>{0, 1});
    CHECK(volume.layout.dimensions[0] == 5);
    CHECK(volume.layout.dimensions[1] == 4);
    CHECK(metadata_value(volume, "dates") == "2001-01-01 00:00 to 2001-01-02 00:00");
    const ValueFacts facts = facts_of(volume);
    CHECK(facts.least == 0);
    CHECK(facts.most == 59.5);
  }
}

TEST_CASE("each prefix of a NetCDF file gives a volume or a message") {
  const Bytes bytes = netcdf_seed("cdf1.nc");
  for (std::size_t n = 0; n < bytes.size(); ++n) {
    const DatasetSample sample(Bytes(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(n)));
    CHECK_FALSE(sample.problem().empty());
  }
}

TEST_CASE("flipped bits of a NetCDF file give a volume or a message") {
  const Bytes bytes = netcdf_seed("cdf5.nc");
  for (std::size_t i = 0; i < bytes.size(); ++i)
    for (const int mask : {0x01, 0x80, 0xff}) {
      Bytes changed = bytes;
      changed[i] ^= static_cast<std::byte>(mask);
      const VolumeResult result = DatasetSample(changed).volume();
      const auto* const volume = std::get_if<qnv::VolumeSource>(&result);
      if (!volume || qnv::voxel_count(volume->layout) > 10'000) continue;
      std::vector<std::byte> scratch;
      std::vector<float> slice(qnv::slice_voxels(volume->layout));
      for (std::uint32_t z = 0; z < volume->layout.dimensions[2]; ++z)
        (void)qnv::read_slice(*volume, z, scratch, slice);
    }
}

TEST_CASE("a truncated NetCDF file names the byte at which values should end") {
  Bytes bytes = netcdf_seed("cdf1.nc");
  bytes.resize(bytes.size() - 4);
  CHECK_THAT(DatasetSample(bytes, "a.nc", dataset_choice("v")).problem(), Catch::Contains("truncated"));
}

TEST_CASE("places longitudes, latitudes and levels by their coordinates") {
  const ScratchFolder folder;
  if (!run_python(folder, R"(
for name, fmt in (('a.nc', 'NETCDF3_CLASSIC'), ('b.nc', 'NETCDF4')):
    d = netCDF4.Dataset(name, 'w', format=fmt)
    d.Conventions = 'CF-1.6'
    for n, c in (('lat', 5), ('lon', 8), ('depth', 3), ('member', 2)): d.createDimension(n, c)
    x = d.createVariable('lon', 'f4', ('lon',)); x.units = 'degrees_east'; x[:] = np.arange(8) * 45
    y = d.createVariable('lat', 'f4', ('lat',)); y.units = 'degrees_north'; y[:] = [60, 30, 0, -30, -60]
    z = d.createVariable('depth', 'f4', ('depth',)); z.units = 'm'; z.positive = 'down'; z[:] = [0, 100, 200]
    v = d.createVariable('temp', 'f4', ('member', 'depth', 'lat', 'lon'), fill_value=-999.)
    v.units = 'degC'; v.missing_value = np.float32(-888)
    a = np.arange(240, dtype='f4').reshape(2, 3, 5, 8); a[0, 0, 0, 0] = -999; a[0, 0, 0, 1] = -888
    v.set_auto_maskandscale(False); v[:] = a
    s = d.createVariable('packed', 'i1', ('lat', 'lon')); s.setncattr('_Unsigned', 'true'); s.scale_factor = 2.0
    s.set_auto_maskandscale(False); s[:] = np.arange(40).reshape(5, 8).astype('i1') - 20
    d.close()
)"))
    return;
  for (const char* const name : {"a.nc", "b.nc"}) {
    INFO(name);
    const Bytes bytes = file_bytes(folder.path(name));
    DatasetSample sample(bytes, name);
    const qnv::VolumeSource volume = sample.opened();
    CHECK(metadata_value(volume, "dataset") == "/temp");
    CHECK(metadata_value(volume, "units") == "degC");
    CHECK(metadata_value(volume, "channel") == "0 of 2");
    CHECK(volume.layout.dimensions == std::array<std::uint32_t, 3>{8, 5, 3});
    CHECK(volume.layout.axes[0] == glm::vec3(45, 0, 0));
    CHECK(volume.layout.axes[1] == glm::vec3(0, -30, 0));
    CHECK(volume.layout.axes[2].z == Approx(-315.0 / 8));  // downwards, a quarter of the width in all
    const ValueFacts facts = facts_of(volume);
    CHECK(facts.missing == 2);
    CHECK(facts.least == 2);
    CHECK(facts.most == 119);
    VoxelComponent second;
    second.channel = 1;
    CHECK(facts_of(DatasetSample(bytes, name, second).opened()).least == 120);
    second.channel = 2;
    CHECK_THAT(DatasetSample(bytes, name, second).problem(), Catch::Contains("no channel 2; expected 0 to 1"));
    const ValueFacts packed = facts_of(DatasetSample(bytes, name, dataset_choice("packed")).opened());
    CHECK(packed.least == 0);
    CHECK(packed.most == 510);
    VoxelComponent globe = dataset_choice("packed");
    globe.globe = true;
    DatasetSample sphere(bytes, name, globe);
    const MeshAsset mesh = sphere.mesh();
    REQUIRE(mesh.parts.size() == 1);
    for (const glm::vec3& point : mesh.parts[0].geometry.positions) CHECK(glm::length(point) == Approx(1));
    CHECK(std::ranges::count(std::span(mesh.parts[0].geometry.coord_index), -1) == 4 * 8);  // closed in the east
  }
}

TEST_CASE("wrong names of datasets list the nearest ones") {
  const DatasetSample sample(netcdf_seed("cdf1.nc"), "a.nc", dataset_choice("vv"));
  CHECK_THAT(sample.problem(), Catch::Contains("no dataset 'vv'; the nearest ones are /v"));
  CHECK_THAT(DatasetSample(netcdf_seed("cdf1.nc"), "a.nc", dataset_choice("lat")).problem(),
             Catch::Contains("expected numbers along 2 to 5 axes"));
}
