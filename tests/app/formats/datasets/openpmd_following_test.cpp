// Series of openPMD in HDF5 that a program still writes.
#include "tests/app/formats/datasets/dataset_helpers.h"

#include <catch2/catch.hpp>

#include <string>
#include <vector>

namespace gs::app::openpmd_following_test {
namespace {

using namespace gs::test;

// Writes a series of one file, and keeps a copy of the file after each iteration, as another program finds it.
constexpr const char* kWriter = R"(
import shutil
f = h5py.File('run.h5', 'w')
f.attrs['openPMD'] = np.bytes_('1.1.0'); f.attrs['basePath'] = np.bytes_('/data/%T/')
f.attrs['meshesPath'] = np.bytes_('fields/'); f.attrs['iterationEncoding'] = np.bytes_('groupBased')
z, y, x = np.mgrid[0:16, 0:16, 0:16]
for i, it in enumerate((100, 200, 300)):
    g = f.create_group(f'data/{it}'); g.attrs['time'] = float(it); g.attrs['timeUnitSI'] = 1.0
    d = g.create_dataset('fields/rho', data=(x + 100.0 * it).astype('f4'))
    d.attrs['gridSpacing'] = [1., 1., 1.]; d.attrs['gridGlobalOffset'] = [0., 0., 0.]; d.attrs['gridUnitSI'] = 1.0
    d.attrs['axisLabels'] = np.array([b'z', b'y', b'x']); d.attrs['unitSI'] = 1.0
    f.flush()
    shutil.copy('run.h5', f'after{i}.h5')
    if it == 300:
        d[...] = 7   # not flushed
        g.attrs['comment'] = np.bytes_('x' * 100)
f.close()
shutil.copy('run.h5', 'closed.h5')
)";

}  // namespace

TEST_CASE("openPMD: each iteration of an open file is a step once the writer has flushed it") {
  const ScratchFolder folder;
  if (!run_python(folder, kWriter)) return;
  for (std::size_t i = 0; i < 3; ++i) {
    INFO(i);
    VoxelComponent choice;
    choice.growing = true;
    const Bytes bytes = file_bytes(folder.path("after" + std::to_string(i) + ".h5"));
    const qnv::VolumeSource source = DatasetSample(bytes, "run.h5", choice).opened();
    CHECK(std::max<std::size_t>(source.steps.size(), 1) == i + 1);
    const qnv::VolumeSource& newest = source.steps.empty() ? source : source.steps.back();
    CHECK(facts_of(newest).most == Approx(15 + 100.0 * 100 * static_cast<double>(i + 1)));
  }
  const qnv::VolumeSource closed = DatasetSample(file_bytes(folder.path("closed.h5")), "run.h5").opened();
  CHECK(closed.steps.size() == 3);
  CHECK(facts_of(closed.steps.back()).most == 7);
}

TEST_CASE("openPMD: a file that is cut while it is written gives a message or complete steps") {
  const ScratchFolder folder;
  if (!run_python(folder, kWriter)) return;
  const Bytes whole = file_bytes(folder.path("after2.h5"));
  for (std::size_t part = 0; part < 16; ++part) {
    INFO(part);
    VoxelComponent choice;
    choice.growing = true;
    const Bytes cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(whole.size() * part / 16));
    DatasetSample sample(cut, "run.h5", choice);
    auto result = sample.volume();
    if (const auto* const problem = std::get_if<std::string>(&result)) {
      CHECK_FALSE(problem->empty());
    } else {
      CHECK(std::get<qnv::VolumeSource>(result).layout.dimensions == std::array<std::uint32_t, 3>{16, 16, 16});
    }
  }
}

}  // namespace gs::app::openpmd_following_test
