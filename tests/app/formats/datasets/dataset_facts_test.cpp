// Compares the datasets of shared files with the facts that other programs read.
#include "qnv/sampling/volume/volume_slices.h"
#include "tests/app/formats/datasets/dataset_helpers.h"

#include <fstream>
#include <map>
#include <regex>

using namespace gs;
using namespace gs::app;
using namespace gs::test;

namespace {

/// Fact of a README: numbers of a dataset.
struct DatasetFact {
  std::string file, dataset;
  std::vector<std::uint64_t> shape;
  std::optional<std::uint64_t> missing;
  double least = 0, most = 0, mean = 0;
};

std::vector<std::uint64_t> fact_shape(const std::string& text) {
  std::vector<std::uint64_t> shape;
  const std::regex number("[0-9]+");
  for (auto at = std::sregex_iterator(text.begin(), text.end(), number); at != std::sregex_iterator(); ++at)
    shape.push_back(std::stoull(at->str()));
  return shape;
}

std::vector<DatasetFact> dataset_facts(const std::filesystem::path& readme) {
  // "data/1/meshes/B/r: float64 (1, 47, 47) min 0 max 1 mean 0.5" of HDF5, and of NetCDF
  // "u('month', 'level') int16: (2, 3) masked 0; unpacked min 0 max 1 mean 0.5"
  const std::regex hdf5(R"(([A-Za-z0-9_/.-]+): [a-z0-9]+ \(([0-9, ]+)\) min (\S+) max (\S+) mean (\S+) chunks)");
  const std::regex netcdf(
      R"(([A-Za-z0-9_]+)\('[^)]*\) [a-z0-9]+: \(([0-9, ]+)\) masked ([0-9]+); unpacked min (\S+) max (\S+) mean (\S+))");
  std::vector<DatasetFact> facts;
  std::ifstream file(readme);
  for (std::string line; std::getline(file, line);) {
    if (!line.starts_with("| ")) continue;
    const std::string name = line.substr(2, line.find(" |", 2) - 2);
    for (auto at = std::sregex_iterator(line.begin(), line.end(), hdf5); at != std::sregex_iterator(); ++at)
      facts.push_back({name, (*at)[1], fact_shape((*at)[2]), std::nullopt, std::stod((*at)[3]), std::stod((*at)[4]),
                       std::stod((*at)[5])});
    for (auto at = std::sregex_iterator(line.begin(), line.end(), netcdf); at != std::sregex_iterator(); ++at)
      facts.push_back({name, (*at)[1], fact_shape((*at)[2]), std::stoull((*at)[3]), std::stod((*at)[4]),
                       std::stod((*at)[5]), std::stod((*at)[6])});
  }
  return facts;
}

double tolerance(const DatasetFact& fact) { return 1e-5 * std::max({std::abs(fact.least), std::abs(fact.most), 1e-9}); }

bool has_metadata(const qnv::VolumeSource& volume, std::string_view key) {
  return std::ranges::any_of(volume.layout.metadata, [key](const auto& pair) { return pair.first == key; });
}

void check_fact(const DatasetFact& fact, const Bytes& bytes, const std::string& path) {
  INFO(fact.file << " " << fact.dataset);
  DatasetSample sample(bytes, path, dataset_choice(fact.dataset));
  const auto entries = sample.entries();
  const auto entry =
      std::ranges::find_if(entries, [&](const DatasetEntry& one) { return one.path == "/" + fact.dataset; });
  REQUIRE(entry != entries.end());
  CHECK(entry->shape == fact.shape);
  if (entry->form != DatasetForm::volume) return;
  const qnv::VolumeSource volume = sample.opened();
  ValueFacts found = facts_of(volume);
  // A volume has one channel of several.
  for (std::uint64_t channel = 1; has_metadata(volume, "channel"); ++channel) {
    VoxelComponent choice = dataset_choice(fact.dataset);
    choice.channel = channel;
    const VolumeResult other = DatasetSample(bytes, path, choice).volume();
    if (std::holds_alternative<std::string>(other)) {
      found.mean /= static_cast<double>(channel);
      break;
    }
    const ValueFacts more = facts_of(std::get<qnv::VolumeSource>(other));
    found.least = std::min(found.least, more.least);
    found.most = std::max(found.most, more.most);
    found.mean += more.mean;
    found.missing += more.missing;
  }
  CHECK(found.least == Approx(fact.least).margin(tolerance(fact)));
  CHECK(found.most == Approx(fact.most).margin(tolerance(fact)));
  // Interpolation to even distances changes the mean.
  if (has_metadata(volume, "uneven axis")) return;
  CHECK(found.mean == Approx(fact.mean).margin(tolerance(fact)));
  if (fact.missing) CHECK(found.missing == *fact.missing);
}

void check_facts(const std::string& folder_name, std::size_t least) {
  const auto folder = shared_folder() / "data" / folder_name;
  if (shared_folder().empty() || !std::filesystem::exists(folder / "README.md")) {
    WARN("the shared files are not here");
    return;
  }
  const auto facts = dataset_facts(folder / "README.md");
  REQUIRE(facts.size() >= least);
  std::map<std::string, Bytes> files;
  for (const DatasetFact& fact : facts) {
    Bytes& bytes = files[fact.file];
    if (bytes.empty()) bytes = file_bytes(folder / fact.file);
    check_fact(fact, bytes, (folder / fact.file).string());
  }
}

}  // namespace

TEST_CASE("HDF5 files of others have the facts that h5py reads") { check_facts("hdf5", 30); }

TEST_CASE("NetCDF files of others have the facts that netCDF4 reads") { check_facts("netcdf", 35); }

TEST_CASE("Exodus II files of others have the points and variables that VTK reads") {
  const auto folder = shared_folder() / "data/exodus";
  if (shared_folder().empty() || !std::filesystem::is_directory(folder)) {
    WARN("the shared files are not here");
    return;
  }
  VoxelComponent last = dataset_choice("aux_elem");
  last.step = qnv::ShownStep{20, std::nullopt};
  DatasetSample mug(file_bytes(folder / "mug.e"), "mug.e", last);
  const MeshAsset mesh = mug.mesh();
  CHECK(mesh.parts[0].geometry.positions.size() == 3774);
  REQUIRE(mesh.color_key);
  CHECK(mesh.color_key->low == Approx(0.009018163).epsilon(1e-4));
  CHECK(mesh.color_key->high == Approx(9.991707).epsilon(1e-4));
  DatasetSample disk(file_bytes(folder / "disk_out_ref.ex2"), "disk_out_ref.ex2", dataset_choice("/nodes/Temp"));
  CHECK(disk.mesh().color_key->title == "Temp");
  CHECK(disk.entries().front().shape == std::vector<std::uint64_t>{1, 8499});
  DatasetSample box(file_bytes(folder / "box-noglom.ex2"), "box-noglom.ex2", dataset_choice("First Cell Array"));
  CHECK(box.mesh().color_key->high == Approx(0.08076924));
}

TEST_CASE("meshes in HDF5 and XDMF files of others have the points and cells that VTK reads") {
  const auto folder = shared_folder() / "data/hdf5";
  if (shared_folder().empty() || !std::filesystem::is_directory(folder)) {
    WARN("the shared files are not here");
    return;
  }
  DatasetSample can(file_bytes(folder / "vtkhdf/can_0.hdf"));
  const MeshAsset solid = can.mesh();
  REQUIRE(solid.parts.size() == 1);
  CHECK(solid.parts[0].geometry.positions.size() == 6724);
  CHECK(std::ranges::count(std::span(solid.parts[0].geometry.coord_index), -1) == 3680);  // outer quadrilaterals
  VoxelComponent last;
  last.step = qnv::ShownStep{99, std::nullopt};
  DatasetSample spheres(file_bytes(folder / "vtkhdf/warping_spheres.vtkhdf"), "spheres", last);
  const MeshAsset warped = spheres.mesh();
  CHECK(warped.parts[0].geometry.positions.size() == 1684);
  CHECK(std::ranges::count(std::span(warped.parts[0].geometry.coord_index), -1) == 3360);
  DatasetSample xdmf(file_bytes(folder / "xdmf/no_checkpoint.xdmf"));
  xdmf.read_file = [&](const std::string& name) -> BytesResult {
    return shared_bytes(file_bytes(folder / "xdmf" / name));
  };
  CHECK(xdmf.mesh().parts[0].geometry.positions.size() == 729);
}
