#include "app/base/local_file.h"
#include "app/commands/common/open_input.h"
#include "app/encode/grids/grid_surface.h"
#include "tests/app/formats/datasets/dataset_helpers.h"
#include "tests/app/scratch_folder.h"
#include "tests/app/surface_triangles.h"
#include "tests/qnv/thread_ranks.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <string>
#include <thread>
#include <vector>

namespace gs::app::array_grid_test {
namespace {

// Writes a grid of hexahedra as VTKHDF with two parts in two steps, and as Exodus II with two element blocks.
constexpr const char* kGridScript = R"(
import h5py, numpy as np
n = 5
def cells_of(layers):
    at = lambda x, y, z: (z * (n + 1) + y) * (n + 1) + x
    c = [[at(x, y, z), at(x + 1, y, z), at(x + 1, y + 1, z), at(x, y + 1, z), at(x, y, z + 1), at(x + 1, y, z + 1),
          at(x + 1, y + 1, z + 1), at(x, y + 1, z + 1)] for z in range(layers) for y in range(n) for x in range(n)
         if (x + 5 * y + 7 * z) % 11]
    return np.array(c)
def points_of(layers, z0=0):
    return np.array([[x, y + .125 * (z % 3), z0 + z + .25 * (x % 2)] for z in range(layers + 1) for y in range(n + 1)
                     for x in range(n + 1)], 'f4')
parts = [(points_of(4), cells_of(4)), (points_of(3, 10), cells_of(3)[:-7])]
def write(name, steps, broken=False, corners='i8'):
    with h5py.File(name, 'w') as f:
        g = f.create_group('VTKHDF'); g.attrs['Version'] = [2, 0]; g.attrs['Type'] = np.bytes_('UnstructuredGrid')
        all = parts * steps
        g['NumberOfPoints'] = [len(p) for p, c in all]; g['NumberOfCells'] = [len(c) for p, c in all]
        g['NumberOfConnectivityIds'] = [8 * len(c) for p, c in all]
        g.create_dataset('Points', data=np.concatenate([p + (0, 0, i // 2) for i, (p, c) in enumerate(all)]),
                         chunks=(50, 3), compression='gzip')
        g['Connectivity'] = np.concatenate([c.ravel() + (999 if broken else 0) for p, c in all]).astype(corners)
        g['Offsets'] = np.concatenate([np.arange(0, 8 * len(c) + 1, 8) for p, c in all])
        g['Types'] = np.full(sum(len(c) for p, c in all), 12, 'u1')
        heat = np.concatenate([(p[:, 0] * 2 + p[:, 2]) * (1 + i // 2) for i, (p, c) in enumerate(all)])
        g['PointData/heat'] = heat
        g['PointData/flow'] = np.stack([heat, heat * 2, heat * 3], -1)
        load = np.arange(sum(len(c) for p, c in all)).astype('f8')
        g['CellData/load'] = load
        g['CellData/vtkGhostType'] = (load % 17 == 3).astype('u1') * 32
        if steps > 1:
            s = g.create_group('Steps'); s.attrs['NSteps'] = steps; s['Values'] = np.arange(steps) / 2.
            per = lambda k: np.arange(steps) * sum(len(one[k]) for one in parts)
            s['PartOffsets'] = np.arange(steps) * 2; s['NumberOfParts'] = np.full(steps, 2)
            s['PointOffsets'] = per(0); s['CellOffsets'] = per(1)[:, None]; s['ConnectivityIdOffsets'] = 8 * per(1)[:, None]
            for a in ('heat', 'flow'): s['PointDataOffsets/' + a] = per(0)
            for a in ('load', 'vtkGhostType'): s['CellDataOffsets/' + a] = per(1)
write('one.vtkhdf', 1); write('steps.vtkhdf', 2); write('broken.vtkhdf', 1, True)
with h5py.File('blocks.e', 'w') as f:
    p, c = parts[0]
    f.attrs['api_version'] = np.float32(4.9)
    for i, a in enumerate('xyz'): f['coord' + a] = p[:, i].astype('f8') + (1e7 if a == 'x' else 0)
    half = len(c) // 2
    for i, part in enumerate((c[:half], c[half:])):
        mid = np.zeros((len(part), 12), 'i4') + 1
        f['connect%d' % (i + 1)] = np.hstack([part + 1, mid]).astype('i4')
        f['connect%d' % (i + 1)].attrs['elem_type'] = np.bytes_('HEX20')
        f['vals_elem_var1eb%d' % (i + 1)] = np.arange(2 * len(part)).reshape(2, len(part)) / 3.
    text = lambda names: np.array([[bytes([b]) for b in n.encode().ljust(33, b'\0')] for n in names], 'S1')
    f['name_nod_var'] = text(['heat']); f['name_elem_var'] = text(['load'])
    f['vals_nod_var1'] = np.stack([p[:, 0], p[:, 0] * 2 + p[:, 2]]).astype('f8')
    f['time_whole'] = [0., 1.]
)";

std::optional<LargeGrid> opened_arrays(const std::string& path, const VoxelComponent& choice,
                                       std::uint64_t memory = 1) {
  auto mapped = net::map_file(path);
  REQUIRE(std::holds_alternative<net::MappedFile>(mapped));
  const auto file = std::make_shared<const net::MappedFile>(std::move(std::get<net::MappedFile>(mapped)));
  VolumeFile source{path, file_name(path), {file, file->bytes()}, reader_beside(path, {})};
  source.component = choice;
  return open_large_grid(source, memory);
}

std::vector<qnv::Triangle> collected(const qnv::TriangleSource& source) {
  std::vector<qnv::Triangle> all;
  CHECK(source([&](std::span<const qnv::Triangle> some) {
    all.insert(all.end(), some.begin(), some.end());
    return true;
  }));
  return all;
}

/// Returns the corners of triangles with their colours, sorted and without duplicates.
std::vector<std::array<float, 6>> corners_of(std::span<const qnv::Triangle> triangles, const glm::dvec3& origin) {
  std::vector<std::array<float, 6>> corners;
  for (const qnv::Triangle& t : triangles)
    for (std::size_t i = 0; i < 3; ++i) {
      const glm::vec3 p(glm::dvec3(t.positions[i]) + origin);
      const qnv::Rgb8& c = t.colors[i];
      corners.push_back({p.x, p.y, p.z, static_cast<float>(c.r), static_cast<float>(c.g), static_cast<float>(c.b)});
    }
  std::ranges::sort(corners);
  corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
  return corners;
}

/// Checks that one process and several ranks give a grid in parts the surface of its import.
void check_surface(const std::string& path, const VoxelComponent& choice, std::size_t parts) {
  const auto grid = opened_arrays(path, choice);
  REQUIRE(grid);
  CHECK(grid->parts.size() == parts);
  qnv::EncodeRanks alone{qnv::EncodeOptions{}};
  const auto made = grid_surface(*grid, alone, 1 << 20, nullptr);
  if (const auto* const problem = std::get_if<qnv::EncodeError>(&made)) FAIL(problem->message);
  const auto& stream = std::get<MeshStream>(made);
  const auto triangles = collected(stream.source);
  InputOptions options;
  options.component = choice;
  const auto input = open_input(options, path);
  REQUIRE(input);
  const auto& whole = std::get<MeshSurface>(input->content);
  const std::vector<qnv::Triangle> imported = test::triangles_of(whole);
  CHECK(imported.size() == triangles.size());
  CHECK(corners_of(triangles, stream.origin) == corners_of(imported, glm::dvec3(0)));
  REQUIRE(whole.color_key);
  REQUIRE(stream.color_key);
  CHECK(color_key_text(*stream.color_key) == color_key_text(*whole.color_key));
  qnv::SharedMemory state(3);
  std::array<std::size_t, 3> counts{};
  std::vector<std::jthread> threads;
  for (std::uint32_t rank = 0; rank < 3; ++rank)
    threads.emplace_back([&, rank] {
      qnv::ThreadRanks ranks(state, rank);
      qnv::RankStore store(state, rank);
      qnv::EncodeOptions shared_options;
      shared_options.ranks = &ranks;
      shared_options.spill = &store;
      qnv::EncodeRanks shared(shared_options);
      const auto result = grid_surface(*grid, shared, 1 << 20, nullptr);
      state.barrier.arrive_and_wait();
      if (const auto* const mesh = std::get_if<MeshStream>(&result)) counts[rank] = mesh->faces;
    });
  threads.clear();
  for (const std::size_t count : counts) CHECK(count == triangles.size());
}

VoxelComponent choice_of(const std::string& dataset, std::size_t step = 0) {
  VoxelComponent choice;
  choice.dataset = dataset;
  choice.step = qnv::ShownStep{};
  choice.step->number = step;
  return choice;
}

}  // namespace

TEST_CASE("grids of VTKHDF and Exodus II that are read in parts have the surfaces of their imports") {
  const ScratchFolder folder;
  if (!test::run_python(folder, kGridScript)) return;
  for (const char* const dataset : {"heat", "load", "flow"}) {
    CAPTURE(dataset);
    check_surface(folder.path("one.vtkhdf"), choice_of(dataset), 2);
  }
  check_surface(folder.path("steps.vtkhdf"), choice_of("/VTKHDF/PointData/heat", 1), 2);
  check_surface(folder.path("steps.vtkhdf"), choice_of("/VTKHDF/CellData/load", 1), 2);
  // Element blocks share their points, so the surface has no faces between them.
  check_surface(folder.path("blocks.e"), choice_of("heat", 1), 2);
  check_surface(folder.path("blocks.e"), choice_of("load", 1), 2);
}

TEST_CASE("refuses grids of VTKHDF and Exodus II with cells that were never written") {
  const ScratchFolder folder;
  if (!test::run_python(folder, R"(
most = 2**31 - 2
with h5py.File('cells.vtkhdf', 'w') as f:
    g = f.create_group('VTKHDF'); g.attrs['Version'] = [2, 0]; g.attrs['Type'] = np.bytes_('UnstructuredGrid')
    g['NumberOfPoints'] = [8]; g['NumberOfCells'] = [most]; g['NumberOfConnectivityIds'] = [8]
    g['Points'] = np.zeros((8, 3), 'f4'); g['Connectivity'] = np.arange(8)
    g.create_dataset('Offsets', (most + 1,), 'i8', chunks=(1024,))[-1] = 8
    g.create_dataset('Types', (most,), 'u1', chunks=(1024,))[-1] = 12
with h5py.File('cells.e', 'w') as f:
    f.attrs['api_version'] = np.float32(4.9)
    for a in 'xyz': f['coord' + a] = np.zeros(8)
    c = f.create_dataset('connect1', (most, 8), 'i4', chunks=(1024, 8)); c.attrs['elem_type'] = np.bytes_('HEX8')
    c[0] = range(1, 9)
)"))
    return;
  const auto problem_of = [&](const char* name) -> std::string {
    const auto grid = opened_arrays(folder.path(name), {});
    REQUIRE(grid);
    qnv::EncodeRanks alone{qnv::EncodeOptions{}};
    const auto made = grid_surface(*grid, alone, 1 << 20, nullptr);
    const auto* const problem = std::get_if<qnv::EncodeError>(&made);
    return problem ? problem->message : std::string();
  };
  CHECK(problem_of("cells.vtkhdf") ==
        "/VTKHDF/Types: the file states 2147483646 elements, but at most 1024 were written; the file is incomplete, "
        "write it again");
  CHECK(problem_of("cells.e") ==
        "/connect1: the file states 17179869168 elements, but at most 8192 were written; the file is incomplete, write "
        "it again");
}

TEST_CASE("a grid in parts hides the cells of its import, with points in any order and with short variables") {
  const ScratchFolder folder;
  if (!test::run_python(folder, std::string(kGridScript) + R"(
write('hidden.vtkhdf', 1)
with h5py.File('hidden.vtkhdf', 'r+') as f:
    g = f['VTKHDF']; count = len(g['Points'])
    g['PointData/vtkGhostType'] = (np.arange(count) * 7 % 31 == 3).astype('u1') * 2
    # Reverses the points of the first part.
    first = g['NumberOfPoints'][0]; ids = 8 * g['NumberOfCells'][0]
    g['Connectivity'][:ids] = first - 1 - g['Connectivity'][:ids]
    for k in ('Points', 'PointData/heat', 'PointData/vtkGhostType'): g[k][:first] = g[k][:first][::-1]
with h5py.File('blocks.e', 'r+') as f:
    short = f['vals_nod_var1'][:, :9]; del f['vals_nod_var1']; f['vals_nod_var1'] = short
)"))
    return;
  check_surface(folder.path("hidden.vtkhdf"), choice_of("heat"), 2);
  CHECK_FALSE(opened_arrays(folder.path("blocks.e"), choice_of("heat")));
  CHECK(opened_arrays(folder.path("blocks.e"), choice_of("load")));
}

TEST_CASE("grids of VTKHDF and Exodus II with damaged arrays give errors or no faces") {
  const ScratchFolder folder;
  if (!test::run_python(folder, std::string(kGridScript) + R"(
for k, change in enumerate((lambda g: g.__delitem__('Types'), lambda g: g['Offsets'].__setitem__(3, 10**6),
                            lambda g: g['NumberOfPoints'].__setitem__(1, 10**9),
                            lambda g: g['NumberOfCells'].__setitem__(0, 2**40),
                            # The numbers of a row, 2**64 + 2, wrap around to 2.
                            lambda g: (g.__delitem__('PointData/heat'), g.create_dataset(
                                'PointData/heat', (400, 3, (2**64 + 2) // 3), 'f4', chunks=(1, 1, 1024)
                            ).__setitem__((0, 0, 0), 1)))):
    write('bad%d.vtkhdf' % k, 1)
    with h5py.File('bad%d.vtkhdf' % k, 'r+') as f: change(f['VTKHDF'])
# Values in a chunk that exceeds caches, and more parts than the program lists.
write('chunk.vtkhdf', 1); write('parts.vtkhdf', 1)
with h5py.File('chunk.vtkhdf', 'r+') as f:
    heat = f['VTKHDF/PointData/heat'][:]; del f['VTKHDF/PointData/heat']
    f.create_dataset('VTKHDF/PointData/heat', data=heat, chunks=(10**6,), maxshape=(None,), compression='gzip')
with h5py.File('parts.vtkhdf', 'r+') as f:
    for k in ('NumberOfPoints', 'NumberOfCells', 'NumberOfConnectivityIds'):
        many = np.concatenate([f['VTKHDF/' + k][:], np.zeros(2**17, 'i8')]); del f['VTKHDF/' + k]; f['VTKHDF/' + k] = many
# A small file that states very many points.
with h5py.File('sparse.vtkhdf', 'w') as f:
    g = f.create_group('VTKHDF'); g.attrs['Version'] = [2, 0]; g.attrs['Type'] = np.bytes_('UnstructuredGrid')
    most, count = 2**31 - 2, 200
    g['NumberOfPoints'] = [most] * count; g['NumberOfCells'] = [1] * count; g['NumberOfConnectivityIds'] = [8] * count
    g.create_dataset('Points', (most * count, 3), 'f4', chunks=(1024, 3))
    g['Connectivity'] = np.zeros(8 * count, 'i4'); g['Offsets'] = [0, 8] * count; g['Types'] = np.full(count, 12, 'u1')
)"))
    return;
  const auto problem_of = [&](const std::string& path) -> std::string {
    const auto grid = opened_arrays(path, choice_of("heat"));
    if (!grid) return "refused";
    qnv::EncodeRanks alone{qnv::EncodeOptions{}};
    const auto made = grid_surface(*grid, alone, 1 << 20, nullptr);
    const auto* const problem = std::get_if<qnv::EncodeError>(&made);
    return problem ? problem->message : std::string();
  };
  CHECK(problem_of(folder.path("one.vtkhdf")).empty());
  CHECK_THAT(problem_of(folder.path("broken.vtkhdf")), Catch::Contains("no faces"));
  for (int k = 0; k < 5; ++k) {
    CAPTURE(k);
    CHECK_FALSE(problem_of(folder.path("bad" + std::to_string(k) + ".vtkhdf")).empty());
  }
  CHECK_FALSE(opened_arrays(folder.path("one.vtkhdf"), choice_of("heat"), 100 << 20));
  CHECK_FALSE(opened_arrays(folder.path("sparse.vtkhdf"), choice_of("/VTKHDF/Points")));
  CHECK_FALSE(opened_arrays(folder.path("parts.vtkhdf"), choice_of("heat")));
  CHECK_FALSE(opened_arrays(folder.path("chunk.vtkhdf"), choice_of("heat")));
  CHECK(opened_arrays(folder.path("chunk.vtkhdf"), choice_of("load")));
}

}  // namespace gs::app::array_grid_test
