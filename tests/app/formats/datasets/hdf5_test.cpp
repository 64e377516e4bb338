#include "qnv/sampling/volume/volume_slices.h"
#include "tests/app/formats/box_checks.h"
#include "tests/app/formats/datasets/dataset_helpers.h"

using namespace gs;
using namespace gs::app;
using namespace gs::test;

namespace {

Bytes hdf5_seed(const std::string& name) {
  return file_bytes(std::string(GHOSTSPACE_TESTS "/fuzz/corpus/app/hdf5/") + name);
}

/// Values of the ball in the files that the tests write.
constexpr const char* kBallScript = R"(
z, y, x = np.mgrid[0:20, 0:30, 0:40]
ball = (100 * np.exp(-((x - 20)**2 + (y - 15)**2 + (z - 10)**2) / 60.)).astype('f4')
)";

std::vector<float> values_of_first_slice(const qnv::VolumeSource& volume) {
  std::vector<std::byte> scratch;
  std::vector<float> slice(qnv::slice_voxels(volume.layout));
  REQUIRE(qnv::read_slice(volume, 0, scratch, slice));
  return slice;
}

}  // namespace

TEST_CASE("reads numbers of each type of HDF5") {
  const ScratchFolder folder;
  if (!run_python(folder, std::string(kBallScript) + R"(
with h5py.File('a.h5', 'w') as f:
    for t in ('u1', 'i1', 'u2', '>u2', 'i2', '>i2', 'u4', 'i4', '>i4', 'u8', '>i8', 'f2', 'f4', '>f4', 'f8', '>f8'):
        f['n' + t.replace('>', 'be')] = np.arange(120).reshape(4, 5, 6).astype(t)
    f['bool'] = ball > 30
    f.create_dataset('enum', data=(ball > 30).astype('i1'), dtype=h5py.special_dtype(enum=('i1', {'no': 0, 'yes': 1})))
    f['complex'] = (ball + 1j * ball * 2).astype('c8')
    f['record'] = np.array(list(zip(range(24), np.arange(24.) * 2)), dtype=[('a', 'i4'), ('b', 'f8')]).reshape(2, 3, 4)
    f['text'] = 'hello'
)"))
    return;
  const Bytes bytes = file_bytes(folder.path("a.h5"));
  for (const char* const type :
       {"u1", "i1", "u2", "beu2", "i2", "bei2", "u4", "i4", "bei4", "u8", "bei8", "f2", "f4", "bef4", "f8", "bef8"}) {
    INFO(type);
    const qnv::VolumeSource volume = DatasetSample(bytes, "a.h5", dataset_choice("n" + std::string(type))).opened();
    CHECK(volume.layout.dimensions == std::array<std::uint32_t, 3>{6, 5, 4});
    std::vector<std::byte> scratch;
    std::vector<float> slice(30);
    for (std::uint32_t z = 4; z-- > 0;) {
      REQUIRE(qnv::read_slice(volume, z, scratch, slice));
      for (std::size_t i = 0; i < 30; ++i) CHECK(slice[i] == static_cast<float>(z * 30 + i));
    }
  }
  for (const char* const name : {"bool", "enum"})
    CHECK(facts_of(DatasetSample(bytes, "a.h5", dataset_choice(name)).opened()).mean == Approx(0.106375));
  const qnv::VolumeSource complex = DatasetSample(bytes, "a.h5", dataset_choice("complex")).opened();
  REQUIRE(complex.components.size() == 2);
  CHECK(facts_of(complex.components[1]).most == Approx(200));
  VoxelComponent length = dataset_choice("complex");
  length.magnitude = length.chosen = true;
  CHECK(facts_of(DatasetSample(bytes, "a.h5", length).opened()).most == Approx(std::sqrt(5.0) * 100));
  const qnv::VolumeSource record = DatasetSample(bytes, "a.h5", dataset_choice("record")).opened();
  REQUIRE(record.components.size() == 2);
  CHECK(facts_of(record.components[1]).most == 46);
  CHECK_THAT(DatasetSample(bytes, "a.h5", dataset_choice("text")).problem(), Catch::Contains("it is text"));
}

TEST_CASE("axes of HDF5 arrays are time, components and space by their names or sizes") {
  const ScratchFolder folder;
  if (!run_python(folder, std::string(kBallScript) + R"(
with h5py.File('a.h5', 'w') as f:
    d = f.create_dataset('a/ball', data=ball, chunks=(8, 8, 8), compression='gzip', shuffle=True)
    d.attrs['element_size_um'] = [2.0, 1.0, 0.5]; d.attrs['unit'] = 'mV'
    f['t'] = np.stack([ball * (i + 1) for i in range(6)])
    f['tc'] = np.stack([np.stack([ball * (i + 1), ball * 0 + i]) for i in range(5)])
    f.create_dataset('grows', data=np.stack([ball, ball * 2, ball * 3]), maxshape=(None, 20, 30, 40))
    f['pair'] = np.stack([ball, ball * 2])
    f['rgb'] = np.stack([(ball * 2).astype('u1')] * 3, axis=-1)
    f['image'] = ball[10]
    f['named'] = ball.transpose(2, 1, 0); f['named'].attrs['axes'] = 'xyz'
    s = f.create_dataset('scaled', data=(ball * 10).astype('i2'))
    s.attrs['scale_factor'] = 0.1; s.attrs['add_offset'] = 5.0; s.attrs['_FillValue'] = np.int16(0)
)"))
    return;
  const Bytes bytes = file_bytes(folder.path("a.h5"));
  const qnv::VolumeSource ball = DatasetSample(bytes, "a.h5", dataset_choice("/a/ball")).opened();
  CHECK(ball.layout.axes[0] == glm::vec3(0.5f, 0, 0));
  CHECK(ball.layout.axes[2] == glm::vec3(0, 0, 2));
  const ValueFacts facts = facts_of(ball);
  CHECK(facts.most == 100);
  const qnv::VolumeSource series = DatasetSample(bytes, "a.h5", dataset_choice("t")).opened();
  REQUIRE(series.steps.size() == 6);
  CHECK(facts_of(series.steps[5]).most == 600);
  VoxelComponent third = dataset_choice("t");
  third.step = qnv::ShownStep{2, std::nullopt};
  CHECK(facts_of(DatasetSample(bytes, "a.h5", third).opened()).most == 300);
  third.step->number = 6;
  CHECK_THAT(DatasetSample(bytes, "a.h5", third).problem(), Catch::Contains("no step 6; expected 0 to 5"));
  const qnv::VolumeSource both = DatasetSample(bytes, "a.h5", dataset_choice("tc")).opened();
  REQUIRE(both.steps.size() == 5);
  REQUIRE(both.steps[3].components.size() == 2);
  CHECK(facts_of(both.steps[3].components[1]).least == 3);
  CHECK(DatasetSample(bytes, "a.h5", dataset_choice("grows")).opened().steps.size() == 3);
  CHECK(DatasetSample(bytes, "a.h5", dataset_choice("pair")).opened().components.size() == 2);
  CHECK(DatasetSample(bytes, "a.h5", dataset_choice("rgb")).opened().layout.colors);
  const qnv::VolumeSource image = DatasetSample(bytes, "a.h5", dataset_choice("image")).opened();
  CHECK(image.layout.dimensions == std::array<std::uint32_t, 3>{40, 30, 1});
  const qnv::VolumeSource named = DatasetSample(bytes, "a.h5", dataset_choice("named")).opened();
  CHECK(named.layout.dimensions == std::array<std::uint32_t, 3>{40, 30, 20});
  CHECK(values_of_first_slice(named) ==
        values_of_first_slice(DatasetSample(bytes, "a.h5", dataset_choice("a/ball")).opened()));
  const ValueFacts scaled = facts_of(DatasetSample(bytes, "a.h5", dataset_choice("scaled")).opened());
  CHECK(scaled.most == Approx(105));
  CHECK(scaled.missing == 3191);
}

TEST_CASE("reads images of VTKHDF and meshes and particles of openPMD") {
  const ScratchFolder folder;
  if (!run_python(folder, std::string(kBallScript) + R"(
with h5py.File('a.vtkhdf', 'w') as f:
    g = f.create_group('VTKHDF'); g.attrs['Version'] = [2, 0]; g.attrs.create('Type', b'ImageData', dtype='S9')
    g.attrs['WholeExtent'] = [0, 39, 0, 29, 0, 19]; g.attrs['Origin'] = [1., 2., 3.]; g.attrs['Spacing'] = [.5, .5, 1.]
    p = g.create_group('PointData'); p['u'] = ball; p['v'] = np.stack([ball] * 3, -1)
    p['GlobalNodeId'] = np.arange(ball.size).reshape(ball.shape)
    g.create_group('CellData')['c'] = ball[1:, 1:, 1:]
    p.attrs['Scalars'] = np.bytes_('u')
with h5py.File('a.h5', 'w') as f:
    f.attrs['openPMD'] = np.bytes_('1.1.0'); f.attrs['meshesPath'] = np.bytes_('fields/')
    f.attrs['particlesPath'] = np.bytes_('particles/')
    for it in (100, 200, 300):
        g = f.create_group(f'data/{it}'); g.attrs['time'] = float(it); g.attrs['timeUnitSI'] = 1e-3
        E = g.create_group('fields/E'); E.attrs['gridSpacing'] = [2., 1., 1.]; E.attrs['gridGlobalOffset'] = [0., 0., 0.]
        E.attrs['gridUnitSI'] = 1e-2; E.attrs['axisLabels'] = np.array([b'z', b'y', b'x'])
        E.attrs['unitDimension'] = [1., 1., -3., -1., 0, 0, 0]
        for c, k in zip('xyz', (1, 2, 3)): E[c] = ball * k * it; E[c].attrs['unitSI'] = 1e3
        for c in 'xyz':
            d = g.create_dataset(f'particles/e/position/{c}', data=np.arange(50.)); d.attrs['unitSI'] = 0.5
            q = g.create_group(f'particles/e/positionOffset/{c}'); q.attrs['value'] = 1.0; q.attrs['unitSI'] = 1.0
        g['particles/e/weighting'] = np.arange(50.)
)"))
    return;
  const Bytes image = file_bytes(folder.path("a.vtkhdf"));
  const qnv::VolumeSource points = DatasetSample(image).opened();
  CHECK(points.layout.origin + points.layout.base == glm::dvec3(1, 2, 3));
  CHECK(points.layout.axes[2] == glm::vec3(0, 0, 1));
  CHECK(facts_of(points).most == 100);
  const qnv::VolumeSource cells = DatasetSample(image, "a", dataset_choice("c")).opened();
  CHECK(cells.layout.origin + cells.layout.base == glm::dvec3(1.25, 2.25, 3.5));
  CHECK(DatasetSample(image, "a", dataset_choice("v")).opened().components.size() == 3);
  const Bytes particles = file_bytes(folder.path("a.h5"));
  const qnv::VolumeSource field = DatasetSample(particles).opened();
  REQUIRE(field.steps.size() == 3);
  CHECK(field.times[2] == Approx(0.3));
  REQUIRE(field.components.size() == 3);
  CHECK(field.layout.axes[2].z == Approx(0.02));
  CHECK(facts_of(field.steps[1].components[2]).most == Approx(3 * 200 * 100 * 1e3));
  DatasetSample electrons(particles, "a", dataset_choice("/data/200/particles/e/weighting"));
  const MeshAsset mesh = electrons.mesh();
  REQUIRE(mesh.parts.size() == 1);
  REQUIRE(mesh.parts[0].geometry.positions.size() == 50);
  CHECK(mesh.parts[0].geometry.positions[10] == glm::vec3(6));
  REQUIRE(mesh.color_key);
  CHECK(mesh.color_key->high == 49);
}

TEST_CASE("HDF5 files never lead to other files, and unknown filters are named") {
  const ScratchFolder folder;
  if (!run_python(folder, std::string(kBallScript) + R"(
with h5py.File('other.h5', 'w') as f: f['secret'] = ball
with h5py.File('a.h5', 'w') as f:
    f['link'] = h5py.ExternalLink('other.h5', '/secret')
    f.create_dataset('outside', shape=ball.shape, dtype='f4', external=[('raw.bin', 0, h5py.h5f.UNLIMITED)])
    layout = h5py.VirtualLayout(shape=ball.shape, dtype='f4'); layout[:] = h5py.VirtualSource('other.h5', 'secret', shape=ball.shape)
    f.create_virtual_dataset('virtual', layout)
    p = h5py.h5p.create(h5py.h5p.DATASET_CREATE); p.set_chunk((4, 30, 40)); p.set_filter(32013, h5py.h5z.FLAG_OPTIONAL)
    h5py.h5d.create(f.id, b'zfp', h5py.h5t.NATIVE_FLOAT, h5py.h5s.create_simple(ball.shape), p)
    f['own'] = ball
)"))
    return;
  const Bytes bytes = file_bytes(folder.path("a.h5"));
  DatasetSample sample(bytes, folder.path("a.h5"));
  CHECK(sample.entries().size() == 4);  // the link is not followed
  CHECK(facts_of(sample.opened()).most == 100);
  for (const char* const name : {"outside", "virtual"})
    CHECK_THAT(DatasetSample(bytes, folder.path("a.h5"), dataset_choice(name)).problem(),
               Catch::Contains("its values lie in other files, which are not read"));
  CHECK_THAT(DatasetSample(bytes, "a.h5", dataset_choice("zfp")).problem(), Catch::Contains("compressed by ZFP"));
}

TEST_CASE("decodes filters that are not part of HDF5") {
  const ScratchFolder folder;
  // Encodes with the C libraries, because Debian has no plugins of HDF5.
  if (!run_python(folder, std::string(kBallScript) + R"(
import ctypes, struct
library = ctypes.CDLL
raw = ball[:4].tobytes()
def blosc():
    l = library('libblosc.so.1'); out = ctypes.create_string_buffer(len(raw) + 16)
    n = ctypes.c_size_t
    size = l.blosc_compress_ctx(5, 1, n(4), n(len(raw)), raw, out, n(len(out)), b'lz4', n(0), 1)
    return out.raw[:size]
def zstd():
    l = library('libzstd.so.1')
    l.ZSTD_compress.restype = ctypes.c_size_t
    out = ctypes.create_string_buffer(len(raw) * 2)
    size = l.ZSTD_compress(out, ctypes.c_size_t(len(out)), raw, ctypes.c_size_t(len(raw)), 3)
    return out.raw[:size]
def lz4():
    l = library('liblz4.so.1'); out = ctypes.create_string_buffer(len(raw) * 2); size = 8192; packed = b''
    for i in range(0, len(raw), size):
        part = raw[i:i + size]; n = l.LZ4_compress_default(part, out, len(part), len(out)); packed += struct.pack('>I', n) + out.raw[:n]
    return struct.pack('>QI', len(raw), size) + packed
with h5py.File('a.h5', 'w') as f:
    f.create_dataset('lzf', data=ball, chunks=(4, 30, 40), compression='lzf')
    f.create_dataset('short', data=(ball * 10).astype('i2'), chunks=(4, 30, 40), compression='lzf', shuffle=True, fletcher32=True)
    for name, number, encode in (('blosc', 32001, blosc), ('lz4', 32004, lz4), ('zstd', 32015, zstd)):
        p = h5py.h5p.create(h5py.h5p.DATASET_CREATE); p.set_chunk((4, 30, 40)); p.set_filter(number, h5py.h5z.FLAG_OPTIONAL)
        d = h5py.h5d.create(f.id, name.encode(), h5py.h5t.NATIVE_FLOAT, h5py.h5s.create_simple((4, 30, 40)), p)
        d.write_direct_chunk((0, 0, 0), encode())
)"))
    return;
  const Bytes bytes = file_bytes(folder.path("a.h5"));
  CHECK(facts_of(DatasetSample(bytes, "a.h5", dataset_choice("lzf")).opened()).mean == Approx(9.976634));
  CHECK(facts_of(DatasetSample(bytes, "a.h5", dataset_choice("short")).opened()).most == 1000);
  const std::vector<float> first = values_of_first_slice(DatasetSample(bytes, "a.h5", dataset_choice("lzf")).opened());
  for (const char* const name : {"blosc", "lz4", "zstd"}) {
    INFO(name);
    CHECK(values_of_first_slice(DatasetSample(bytes, "a.h5", dataset_choice(name)).opened()) == first);
  }
}

TEST_CASE("each prefix of an HDF5 file gives a volume or a message") {
  const Bytes bytes = hdf5_seed("gzip.h5");
  REQUIRE(DatasetSample(bytes).problem().empty());
  for (std::size_t n = 0; n < bytes.size(); n += 7)
    CHECK_FALSE(
        DatasetSample(Bytes(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(n)), "a.h5").problem().empty());
}

TEST_CASE("many slices of chunked arrays are read within the memory of a world") {
  const ScratchFolder folder;
  if (!run_python(folder, R"(
with h5py.File('a.h5', 'w') as f:
    f.create_dataset('a', shape=(200, 512, 512), dtype='f4', chunks=(64, 64, 64), compression='gzip', compression_opts=1)
    for z in range(0, 200, 50): f['a'][z] = z
)"))
    return;
  const Bytes bytes = file_bytes(folder.path("a.h5"));
  Limits limits;
  limits.memory = std::size_t{64} << 20;  // the array has 200 MiB
  const WorldBudget budget = std::make_shared<Budget>(limits);
  const auto opened = open_datasets({"a.h5", "a.h5", shared_bytes(bytes), {}, budget, {}});
  REQUIRE(std::holds_alternative<qnv::VolumeSource>(opened));
  const auto& volume = std::get<qnv::VolumeSource>(opened);
  std::vector<std::byte> scratch;
  std::vector<float> slice(qnv::slice_voxels(volume.layout));
  for (std::uint32_t z = 0; z < 200; z += 50) {
    REQUIRE(qnv::read_slice(volume, z, scratch, slice));
    CHECK(slice[1000] == static_cast<float>(z));
    CHECK(budget->used(Resource::volumes) <= budget->limit(Resource::volumes));
  }
}

TEST_CASE("reads boxes of voxels from contiguous and chunked datasets of HDF5") {
  const ScratchFolder folder;
  if (!run_python(folder, std::string(kBallScript) + R"(
with h5py.File('a.h5', 'w') as f:
    f['plain'] = ball
    f.create_dataset('chunks', data=ball, chunks=(7, 8, 9), compression='gzip')
    f.create_dataset('thin', data=(ball * 9).astype('i8'), chunks=(1, 30, 40))
    f.create_dataset('parts', data=np.stack([ball, 2 * ball, 3 * ball], axis=-1), chunks=(4, 8, 16, 3))
    valid = f.create_dataset('limits', data=ball, chunks=(5, 6, 7))
    valid.attrs['valid_min'] = np.float32(10)
)"))
    return;
  const Bytes bytes = file_bytes(folder.path("a.h5"));
  for (const char* const name : {"plain", "chunks", "thin", "parts", "limits"}) {
    INFO(name);
    const qnv::VolumeSource volume = DatasetSample(bytes, "a.h5", dataset_choice(name)).opened();
    check_boxes(volume);
    for (const qnv::VolumeSource& component : volume.components) check_boxes(component);
  }
  const auto chunk_of = [&](const char* name) {
    return DatasetSample(bytes, "a.h5", dataset_choice(name)).opened().chunk;
  };
  CHECK(chunk_of("plain") == std::array<std::uint32_t, 3>{});
  CHECK(chunk_of("chunks") == std::array<std::uint32_t, 3>{9, 8, 7});
  CHECK(chunk_of("parts") == std::array<std::uint32_t, 3>{16, 8, 4});
}
