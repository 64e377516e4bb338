#include "app/formats/volume/volume.h"
#include "net/base/range_set.h"
#include "qnv/sampling/volume/volume_slices.h"
#include "tests/app/formats/datasets/dataset_helpers.h"

#include <filesystem>
#include <set>

using namespace gs;
using namespace gs::app;
using namespace gs::test;

namespace parts_test {
namespace {

/// File with only its first bytes present. It provides other bytes when they are needed.
class PartlyThere {
 public:
  PartlyThere(Bytes all, std::size_t front) : all_(std::move(all)), there_(all_.size()) {
    std::copy_n(all_.begin(), front, there_.begin());
  }
  [[nodiscard]] SharedBytes bytes() const { return {nullptr, std::span<const std::byte>(there_)}; }
  [[nodiscard]] NeedBytes need() {
    return [this](std::span<const ByteSpan> parts) {
      bool is_new = false;
      for (const ByteSpan& part : parts) {
        if (!fails && part.bytes > 0 && known_.contains({part.offset, part.offset + part.bytes})) continue;
        is_new = true;
        if (fails || part.offset > all_.size() || part.bytes > all_.size() - part.offset) return false;
        std::copy_n(all_.begin() + static_cast<std::ptrdiff_t>(part.offset), part.bytes,
                    there_.begin() + static_cast<std::ptrdiff_t>(part.offset));
        given += part.bytes;
        known_.add({part.offset, part.offset + part.bytes});
      }
      calls += is_new ? 1 : 0;
      return true;
    };
  }
  std::size_t calls = 0, given = 0;
  bool fails = false;

 private:
  const Bytes all_;
  Bytes there_;
  net::RangeSet known_;
};

/// Returns the minimum number of first bytes that identify a file as readable by parts; nullopt if it is not.
std::optional<std::size_t> front_of(const std::string& name, const Bytes& bytes) {
  for (std::size_t count = 1; count <= std::min<std::size_t>(bytes.size(), 40'000); ++count)
    if (reads_by_parts(name, std::span(bytes).first(count))) return count;
  return std::nullopt;
}

using Opened = std::variant<qnv::VolumeSource, std::string>;

Opened open_parts(const std::string& name, PartlyThere& file) {
  VolumeOrigin origin;
  origin.need = file.need();
  return open_volume_file(name, file.bytes(), {}, origin, own_budget());
}
Opened open_whole(const std::string& name, const Bytes& bytes) {
  return open_volume_file(name, SharedBytes{nullptr, bytes}, {}, {}, own_budget());
}

std::vector<const qnv::VolumeSource*> sources_of(const qnv::VolumeSource& volume) {
  std::vector<const qnv::VolumeSource*> all{&volume};
  for (const qnv::VolumeSource& one : volume.components) all.push_back(&one);
  for (const qnv::VolumeSource& one : volume.steps) all.push_back(&one);
  return all;
}

Bytes box_in(const qnv::VolumeSource& source, const qnv::VoxelBox& box) {
  Bytes voxels(static_cast<std::size_t>(qnv::voxel_count(box)) * qnv::size_of(source.layout.type));
  REQUIRE(qnv::read_voxels(source, box, voxels));
  return voxels;
}

/// Boxes of a volume: all, every second voxel, and a part.
std::vector<qnv::VoxelBox> boxes_in(const std::array<std::uint32_t, 3>& size) {
  std::vector<qnv::VoxelBox> boxes{{{0, 0, 0}, size, {1, 1, 1}}};
  qnv::VoxelBox second, part;
  for (std::size_t a = 0; a < 3; ++a) {
    second.step[a] = 2;
    second.size[a] = (size[a] + 1) / 2;
    part.step[a] = 1;
    part.first[a] = size[a] / 3;
    part.size[a] = (size[a] + 1) / 2;
    part.size[a] = std::min(part.size[a], size[a] - part.first[a]);
  }
  boxes.push_back(second);
  boxes.push_back(part);
  return boxes;
}

}  // namespace

TEST_CASE("files are read by parts like as a whole") {
  std::set<std::string> formats;
  for (const char* const format : {"hdf5", "metaimage", "netcdf", "nifti", "nrrd", "tiff"})
    for (const auto& entry :
         std::filesystem::directory_iterator(std::string(GHOSTSPACE_TESTS "/fuzz/corpus/app/") + format)) {
      const std::string name = entry.path().filename().string();
      const Bytes bytes = file_bytes(entry.path().string());
      const auto front = front_of(name, bytes);
      if (!front) continue;
      INFO(format << ' ' << name);
      const Opened whole = open_whole(name, bytes);
      PartlyThere partly(bytes, *front);
      const Opened parts = open_parts(name, partly);
      REQUIRE(whole.index() == parts.index());
      if (const auto* const problem = std::get_if<std::string>(&whole)) {
        CHECK(std::get<std::string>(parts) == *problem);
        continue;
      }
      formats.insert(format);
      const auto theirs = sources_of(std::get<0>(whole)), ours = sources_of(std::get<0>(parts));
      REQUIRE(theirs.size() == ours.size());
      for (std::size_t i = 0; i < ours.size(); ++i)
        for (const qnv::VoxelBox& box : boxes_in(theirs[i]->layout.dimensions)) {
          // Uses a file that was not read before.
          PartlyThere fresh(bytes, *front);
          const Opened opened = open_parts(name, fresh);
          CHECK(box_in(*sources_of(std::get<0>(opened))[i], box) == box_in(*theirs[i], box));
        }
      for (std::size_t i = 0; i < ours.size(); ++i)
        CHECK(box_in(*ours[i], boxes_in(ours[i]->layout.dimensions)[0]) ==
              box_in(*theirs[i], boxes_in(theirs[i]->layout.dimensions)[0]));
    }
  CHECK(formats.size() == 6);
}

TEST_CASE("parts that cannot be received give a message or a failed read") {
  for (const char* const file : {"hdf5/plain.h5", "netcdf/cdf5.nc"}) {
    const std::string path = std::string(GHOSTSPACE_TESTS "/fuzz/corpus/app/") + file;
    if (!std::filesystem::exists(path)) continue;
    PartlyThere partly(file_bytes(path), 64);
    partly.fails = true;
    CHECK(std::holds_alternative<std::string>(open_parts(file, partly)));
  }
  std::string text = "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 10 10 10\nencoding: raw\n\n";
  const std::size_t front = text.size();
  text += std::string(1000, 'a');
  const auto raw = std::as_bytes(std::span(text));
  PartlyThere partly(Bytes(raw.begin(), raw.end()), front);
  const Opened opened = open_parts("a.nrrd", partly);
  REQUIRE(std::holds_alternative<qnv::VolumeSource>(opened));
  Bytes slice(100);
  CHECK(std::get<0>(opened).read(3, slice));
  CHECK(partly.given == 100);
  partly.fails = true;
  CHECK_FALSE(std::get<0>(opened).read(4, slice));
  CHECK_FALSE(std::get<0>(opened).read_box({{0, 0, 5}, {10, 10, 1}, {1, 1, 1}}, slice));
}

TEST_CASE("files that must be unpacked or name others are not read by parts") {
  const auto reads = [](const std::string& name, const std::string& text) {
    return reads_by_parts(name, std::as_bytes(std::span(text)));
  };
  const std::string head = "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 10 10 10\n";
  CHECK(reads("a.nrrd", head + "encoding: raw\n\n"));
  CHECK_FALSE(reads("a.nrrd", head + "encoding: raw\n"));
  CHECK_FALSE(reads("a.nrrd", head + "encoding: gzip\n\n"));
  CHECK_FALSE(reads("a.nhdr", head + "encoding: raw\ndata file: a.raw\n\n"));
  CHECK_FALSE(reads("a.fits", "SIMPLE  =                    T"));
  CHECK(may_read_by_parts("a.h5"));
  CHECK(may_read_by_parts("B.TIF"));
  CHECK_FALSE(may_read_by_parts("a.h5.gz"));
  CHECK_FALSE(may_read_by_parts("a.wrl"));
  CHECK_FALSE(may_read_by_parts("a.qnv"));
}

TEST_CASE("a box of chunks needs one call for their values") {
  const ScratchFolder folder;
  if (!run_python(folder, R"(
with h5py.File('a.h5', 'w') as f:
    f.create_dataset('v', data=np.random.default_rng(1).integers(0, 999, (64, 64, 64)).astype('i2'),
                     chunks=(16, 16, 16), compression='gzip')
    f['c'] = np.arange(64**3, dtype='i4').reshape(64, 64, 64)
)"))
    return;
  const Bytes bytes = file_bytes(folder.path("a.h5"));
  for (const bool chunked : {true, false}) {
    PartlyThere partly(bytes, 2048);
    VolumeOrigin origin;
    origin.need = partly.need();
    origin.component.dataset = chunked ? "v" : "c";
    const Opened opened = open_volume_file("a.h5", partly.bytes(), {}, origin, own_budget());
    REQUIRE(std::holds_alternative<qnv::VolumeSource>(opened));
    const qnv::VolumeSource& volume = std::get<0>(opened);
    const std::size_t number = qnv::size_of(volume.layout.type);
    // Metadata of the dataset are read with the first values.
    Bytes one(number);
    REQUIRE(qnv::read_voxels(volume, {{63, 63, 63}, {1, 1, 1}, {1, 1, 1}}, one));
    const std::size_t given = partly.given;
    Bytes box(std::size_t{32} * 32 * 32 * number);
    REQUIRE(qnv::read_voxels(volume, {{0, 0, 0}, {32, 32, 32}, {1, 1, 1}}, box));
    // An eighth of the values.
    CHECK(partly.given - given < bytes.size() / 3);
    const std::size_t calls = partly.calls;
    Bytes again(box.size());
    REQUIRE(qnv::read_voxels(volume, {{32, 0, 0}, {32, 32, 32}, {1, 1, 1}}, again));
    CHECK(partly.calls - calls < 30);
  }
}

}  // namespace parts_test
