#include "app/base/local_file.h"
#include "app/formats/datasets/zarr/zarr_place.h"

#include <zlib.h>
#include <zstd.h>
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

namespace gs::app::zarr_test {
namespace {

using Files = std::map<std::string, std::string>;

/// Container in memory.
ZarrPlace place_of(Files files) {
  const auto held = std::make_shared<const Files>(std::move(files));
  ZarrPlace place;
  place.read = [held](std::span<const FileRequest> requests) {
    std::vector<FileResult> results;
    for (const FileRequest& request : requests) {
      const auto found = held->find(request.reference);
      if (found == held->end()) {
        results.emplace_back(NoFile());
        continue;
      }
      if (found->second == "unreadable") {
        results.emplace_back(std::string("no permission"));
        continue;
      }
      const auto bytes = std::as_bytes(std::span(found->second));
      results.push_back(part_of(shared_bytes(std::vector<std::byte>(bytes.begin(), bytes.end())), request.part));
    }
    return results;
  };
  place.list = [held](const std::string& folder) -> std::optional<std::vector<std::string>> {
    std::vector<std::string> names;
    const std::string prefix = folder == "." ? "" : folder + "/";
    for (const auto& [path, content] : *held)
      if (path.starts_with(prefix))
        names.push_back(path.substr(prefix.size(), path.find('/', prefix.size()) - prefix.size()));
    return names;
  };
  return place;
}

std::shared_ptr<ZarrFile> opened(Files files) {
  auto result = ZarrFile::open(place_of(std::move(files)));
  if (const auto* const problem = std::get_if<std::string>(&result)) FAIL(*problem);
  return std::get<std::shared_ptr<ZarrFile>>(result);
}

template <class T>
std::vector<T> all_of(ZarrFile& file, std::size_t array = 0) {
  const ArrayInfo& info = file.arrays().at(array);
  std::uint64_t count = 1;
  for (const std::uint64_t extent : info.shape) count *= extent;
  std::vector<T> values(static_cast<std::size_t>(count));
  const std::vector<std::uint64_t> first(info.shape.size());
  const std::string problem = file.read(array, first, info.shape, std::as_writable_bytes(std::span(values)));
  INFO(problem);
  REQUIRE(problem.empty());
  return values;
}

template <class T>
std::string bytes_of_numbers(std::initializer_list<T> numbers) {
  return {reinterpret_cast<const char*>(std::data(numbers)), numbers.size() * sizeof(T)};
}

std::string v2(const std::string& shape, const std::string& chunks, const std::string& type,
               const std::string& more = "\"compressor\":null,\"fill_value\":0,\"order\":\"C\"") {
  return "{\"zarr_format\":2,\"shape\":" + shape + ",\"chunks\":" + chunks + ",\"dtype\":\"" + type +
         "\",\"filters\":null," + more + "}";
}
std::string v3(const std::string& shape, const std::string& chunks, const std::string& type, const std::string& codecs,
               const std::string& fill = "0") {
  return "{\"zarr_format\":3,\"node_type\":\"array\",\"shape\":" + shape + ",\"data_type\":\"" + type +
         "\",\"chunk_grid\":{\"name\":\"regular\",\"configuration\":{\"chunk_shape\":" + chunks +
         "}},\"chunk_key_encoding\":{\"name\":\"default\"},\"fill_value\":" + fill + ",\"codecs\":" + codecs + "}";
}
constexpr const char* kBytes = "[{\"name\":\"bytes\",\"configuration\":{\"endian\":\"little\"}}]";

/// Returns the CRC-32C of bytes, bit by bit.
std::uint32_t crc32c_of(std::string_view bytes) {
  std::uint32_t crc = 0xffffffff;
  for (const char c : bytes) {
    crc ^= static_cast<unsigned char>(c);
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ ((crc & 1) != 0 ? 0x82f63b78u : 0);
  }
  return ~crc;
}

TEST_CASE("zarr: Chunks of version 2 are put together, and missing ones have the fill value") {
  Files files{{".zarray", v2("[3,3]", "[2,2]", "<i2", "\"compressor\":null,\"fill_value\":-7,\"order\":\"C\"")},
              {"0.0", bytes_of_numbers<std::int16_t>({1, 2, 3, 4})},
              {"0.1", bytes_of_numbers<std::int16_t>({5, 0, 6, 0})},
              {"1.1", bytes_of_numbers<std::int16_t>({9, 0, 0, 0})}};
  const auto file = opened(files);
  CHECK(all_of<std::int16_t>(*file) == std::vector<std::int16_t>{1, 2, 5, 3, 4, 6, -7, -7, 9});
  CHECK(file->trouble().empty());
}

TEST_CASE("zarr: Boxes across chunks have the elements of the whole array") {
  Files files{{".zarray", v2("[5,4,3]", "[2,3,2]", ">u2")}};
  for (int z = 0; z < 3; ++z)
    for (int y = 0; y < 2; ++y)
      for (int x = 0; x < 2; ++x) {
        std::string chunk;
        for (int k = 0; k < 2; ++k)
          for (int j = 0; j < 3; ++j)
            for (int i = 0; i < 2; ++i) {
              const int value = (z * 2 + k) * 100 + (y * 3 + j) * 10 + x * 2 + i;
              chunk += static_cast<char>(value >> 8);
              chunk += static_cast<char>(value);
            }
        files[std::to_string(z) + "." + std::to_string(y) + "." + std::to_string(x)] = chunk;
      }
  const auto file = opened(files);
  const std::vector<std::uint64_t> shape{5, 4, 3};
  for (std::uint64_t z = 0; z < 5; ++z)
    for (std::uint64_t y = 0; y < 4; ++y)
      for (std::uint64_t x = 0; x < 3; ++x)
        for (std::uint64_t dz = 1; z + dz <= 5; dz += 2)
          for (std::uint64_t dy = 1; y + dy <= 4; ++dy) {
            const std::vector<std::uint64_t> first{z, y, x}, count{dz, dy, 3 - x};
            std::vector<std::uint16_t> box(static_cast<std::size_t>(dz * dy * (3 - x)));
            REQUIRE(file->read(0, first, count, std::as_writable_bytes(std::span(box))).empty());
            std::size_t at = 0;
            for (std::uint64_t k = 0; k < dz; ++k)
              for (std::uint64_t j = 0; j < dy; ++j)
                for (std::uint64_t i = x; i < 3; ++i) REQUIRE(box[at++] == (z + k) * 100 + (y + j) * 10 + i);
          }
  std::vector<std::uint16_t> box(4);
  const std::vector<std::uint64_t> outside{4, 3, 2}, two{2, 1, 2};
  CHECK_FALSE(file->read(0, outside, two, std::as_writable_bytes(std::span(box))).empty());
}

TEST_CASE("zarr: Chunks that cannot be read become missing, are counted, and the rest stays") {
  Files files{{".zarray", v2("[4]", "[1]", "<f4")},
              {"0", bytes_of_numbers<float>({1})},
              {"1", "xy"},
              {"2", "unreadable"},
              {"3", bytes_of_numbers<float>({4})}};
  const auto file = opened(files);
  const auto values = all_of<float>(*file);
  CHECK(values[0] == 1);
  CHECK(std::isnan(values[1]));
  CHECK(std::isnan(values[2]));
  CHECK(values[3] == 4);
  CHECK(file->trouble() ==
        "/: 2 chunks cannot be read and are drawn as missing; the first one: 1: it has 2 bytes; "
        "expected 4");
}

TEST_CASE("zarr: Every prefix of a compressed chunk is refused, and no prefix gives other values") {
  std::string plain(4096, '\0');
  for (std::size_t i = 0; i < plain.size(); ++i) plain[i] = static_cast<char>(i * i / 7);
  std::string packed(ZSTD_compressBound(plain.size()), '\0');
  packed.resize(ZSTD_compress(packed.data(), packed.size(), plain.data(), plain.size(), 3));
  std::string zipped(compressBound(plain.size()), '\0');
  uLongf length = zipped.size();
  REQUIRE(compress(reinterpret_cast<Bytef*>(zipped.data()), &length, reinterpret_cast<const Bytef*>(plain.data()),
                   plain.size()) == Z_OK);
  zipped.resize(length);
  for (const auto& [codec, bytes] : {std::pair<std::string, std::string>{"zstd", packed}, {"zlib", zipped}}) {
    const std::string metadata =
        v2("[4096]", "[4096]", "|u1", "\"compressor\":{\"id\":\"" + codec + "\"},\"fill_value\":9,\"order\":\"C\"");
    for (std::size_t size = 0; size <= bytes.size(); size += size + 64 < bytes.size() ? 61 : 1) {
      const auto file = opened({{".zarray", metadata}, {"0", bytes.substr(0, size)}});
      const auto values = all_of<std::uint8_t>(*file);
      const bool whole = file->trouble().empty();
      INFO(codec << " " << size << " of " << bytes.size());
      if (whole)
        REQUIRE(std::equal(values.begin(), values.end(), reinterpret_cast<const std::uint8_t*>(plain.data())));
      else
        REQUIRE(std::ranges::count(values, 9) == 4096);
      if (size == bytes.size()) REQUIRE(whole);
    }
  }
}

TEST_CASE("zarr: Shards give their chunks, and a damaged index is reported") {
  const auto number = [](std::uint64_t value) {
    std::string bytes;
    for (int i = 0; i < 8; ++i) bytes += static_cast<char>(value >> (8 * i));
    return bytes;
  };
  const std::string none = number(~std::uint64_t{0});
  const std::string one = bytes_of_numbers<std::uint16_t>({1, 2}), two = bytes_of_numbers<std::uint16_t>({5, 6});
  std::string index = number(0) + number(4) + none + none + number(4) + number(4) + none + none;
  const std::uint32_t crc = crc32c_of(index);
  for (int i = 0; i < 4; ++i) index += static_cast<char>(crc >> (8 * i));
  const std::string codecs =
      "[{\"name\":\"sharding_indexed\",\"configuration\":{\"chunk_shape\":[2],\"codecs\":" + std::string(kBytes) +
      ",\"index_codecs\":[{\"name\":\"bytes\",\"configuration\":{\"endian\":\"little\"}},{\"name\":\"crc32c\"}],"
      "\"index_location\":\"end\"}}]";
  Files files{{"zarr.json", v3("[8]", "[8]", "uint16", codecs, "3")}, {"c/0", one + two + index}};
  CHECK(all_of<std::uint16_t>(*opened(files)) == std::vector<std::uint16_t>{1, 2, 3, 3, 5, 6, 3, 3});
  for (std::size_t at = 8; at < files["c/0"].size(); ++at) {
    Files damaged = files;
    damaged["c/0"][at] ^= 4;
    const auto file = opened(damaged);
    (void)all_of<std::uint16_t>(*file);
    INFO(at);
    REQUIRE(file->trouble().find("the checksum of its index differs") != std::string::npos);
  }
}

TEST_CASE("zarr: Transposed chunks, halves, complex numbers and N5 blocks are read") {
  const std::string order = "[{\"name\":\"transpose\",\"configuration\":{\"order\":[1,0]}},{\"name\":\"bytes\"}]";
  CHECK(all_of<std::uint8_t>(
            *opened({{"zarr.json", v3("[2,3]", "[2,3]", "uint8", order)}, {"c/0/0", std::string("\1\4\2\5\3\6")}})) ==
        std::vector<std::uint8_t>{1, 2, 3, 4, 5, 6});
  const auto halves = opened(
      {{".zarray", v2("[4]", "[4]", "<f2")}, {"0", bytes_of_numbers<std::uint16_t>({0x3c00, 0xc000, 0x7c00, 0x0001})}});
  CHECK(all_of<float>(*halves) ==
        std::vector<float>{1, -2, std::numeric_limits<float>::infinity(), std::ldexp(1.0f, -24)});
  const auto complex = opened({{".zarray", v2("[1]", "[1]", "<c8")}, {"0", bytes_of_numbers<float>({3, 4})}});
  CHECK(complex->arrays().front().parts == 2);
  std::vector<float> both(2);
  const std::vector<std::uint64_t> zero{0}, unit{1};
  REQUIRE(complex->read(0, zero, unit, std::as_writable_bytes(std::span(both))).empty());
  CHECK(both == std::vector<float>{3, 4});
  const std::string block("\0\0\0\2\0\0\0\2\0\0\0\1\0\7\0\10", 16);
  const auto n5 =
      opened({{"attributes.json",
               "{\"dimensions\":[3,2],\"blockSize\":[3,2],\"dataType\":\"uint16\",\"compression\":{\"type\":"
               "\"raw\"}}"},
              {"0/0", block}});
  CHECK(n5->arrays().front().shape == std::vector<std::uint64_t>{2, 3});
  CHECK(all_of<std::uint16_t>(*n5) == std::vector<std::uint16_t>{7, 8, 0, 0, 0, 0});
}

TEST_CASE("zarr: the codec delta gives the sums of differences, in each byte order") {
  const std::string delta = "{\"name\":\"numcodecs.delta\",\"configuration\":{\"dtype\":\"<i2\",\"astype\":\"<i2\"}}";
  const auto metadata = [&](const std::string& endian) {
    return v3("[4]", "[4]", "int16",
              "[" + delta + ",{\"name\":\"bytes\",\"configuration\":{\"endian\":\"" + endian + "\"}}]");
  };
  const std::vector<std::int16_t> expected{5, -1, 32767, -32768};
  CHECK(all_of<std::int16_t>(*opened({{"zarr.json", metadata("little")},
                                      {"c/0", bytes_of_numbers<std::int16_t>({5, -6, -32768, 1})}})) == expected);
  CHECK(all_of<std::int16_t>(
            *opened({{"zarr.json", metadata("big")}, {"c/0", std::string("\0\5\xff\xfa\x80\0\0\1", 8)}})) == expected);
  std::string second = v2("[3]", "[3]", "|u1");
  second.replace(second.find("\"filters\":null"), 14, "\"filters\":[{\"id\":\"delta\",\"dtype\":\"|u1\"}]");
  CHECK(all_of<std::uint8_t>(*opened({{".zarray", second}, {"0", std::string("\3\377\2")}})) ==
        std::vector<std::uint8_t>{3, 2, 4});
  for (const char* const type : {"<i4", "<f2", "<i3", "", "<i16"}) {
    INFO(type);
    std::string other = metadata("little");
    for (std::size_t at = other.find("<i2"); at != std::string::npos; at = other.find("<i2"))
      other.replace(at, 3, type);
    CHECK(opened({{"zarr.json", other}})->arrays().front().problem.find("delta") != std::string::npos);
  }
  // Differences across the chunks of a shard are not undone in each chunk.
  const std::string shards =
      "[" + delta + ",{\"name\":\"sharding_indexed\",\"configuration\":{\"chunk_shape\":[2],\"codecs\":" + kBytes +
      ",\"index_codecs\":[{\"name\":\"bytes\",\"configuration\":{\"endian\":\"little\"}}]}}]";
  const std::string problem = opened({{"zarr.json", v3("[4]", "[4]", "int16", shards)}})->arrays().front().problem;
  CHECK(problem.find("inside of the shards") != std::string::npos);
}

TEST_CASE("zarr: Hostile metadata give one reason each") {
  const std::pair<std::string, std::string> cases[] = {
      {v2("[-1]", "[1]", "<i2"), "shape"},
      {v2("[1]", "[0]", "<i2"), "chunks"},
      {v2("[1,2]", "[1]", "<i2"), "dimensions"},
      {v2("[1e99]", "[1]", "<i2"), "shape"},
      {v2("[281474976710656,281474976710656]", "[1,1]", "<i2"), "too many elements"},
      {v2("[99999999999]", "[99999999999]", "<i2"), "MiB"},
      {v2("[1]", "[1]", "<q9"), "type"},
      {v2("[1]", "[1]", "|O"), "type"},
      {v2("[1]", "[1]", "<i2", "\"compressor\":{\"id\":\"magic\"},\"fill_value\":0"), "unknown codec magic"},
      {v2("[]", "[]", "<i2"), "shape"},
      {v2("\"x\"", "[1]", "<i2"), "shape"}};
  for (const auto& [metadata, reason] : cases) {
    INFO(metadata);
    const auto file = opened({{".zarray", metadata}});
    REQUIRE(file->arrays().size() == 1);
    CHECK(file->arrays().front().problem.find(reason) != std::string::npos);
    const std::vector<std::uint64_t> zero{0}, unit{1};
    std::vector<std::byte> to(2);
    CHECK_FALSE(file->read(0, zero, unit, to).empty());
  }
  for (const char* const codecs :
       {"[]", "[{\"name\":\"zstd\"}]",
        "[{\"name\":\"transpose\",\"configuration\":{\"order\":[0,0]}},{\"name\":\"bytes\"}]",
        "[{\"name\":\"bytes\"},{\"name\":\"transpose\"}]",
        "[{\"name\":\"bytes\"},{\"name\":\"numcodecs.delta\",\"configuration\":{\"dtype\":\"|i1\"}}]",
        "[{\"name\":\"sharding_indexed\",\"configuration\":{\"chunk_shape\":[3],\"codecs\":[{\"name\":\"bytes\"}]}}]",
        "[{\"name\":\"sharding_indexed\",\"configuration\":{\"chunk_shape\":[4]}}]"}) {
    INFO(codecs);
    CHECK_FALSE(opened({{"zarr.json", v3("[8]", "[8]", "int8", codecs)}})->arrays().front().problem.empty());
  }
  CHECK(std::holds_alternative<std::string>(ZarrFile::open(place_of({{"zarr.json", "{"}}))));
  CHECK(std::holds_alternative<std::string>(ZarrFile::open(place_of({{"zarr.json", std::string(100'000, '[')}}))));
  CHECK(std::holds_alternative<std::string>(ZarrFile::open(place_of({{"readme", "x"}}))));
  // A path must stay in the container.
  const auto outside = opened({{".zattrs", "{\"multiscales\":[{\"datasets\":[{\"path\":\"../../etc\"}]}]}"}});
  CHECK(outside->images().empty());
}

TEST_CASE("zarr: Images of OME-Zarr have levels, axes and labels") {
  Files files{
      {".zgroup", "{\"zarr_format\":2}"},
      {".zattrs",
       "{\"multiscales\":[{\"axes\":[{\"name\":\"c\",\"type\":\"channel\"},{\"name\":\"y\",\"type\":\"space\",\"unit\":"
       "\"micrometer\"},{\"name\":\"x\",\"type\":\"space\"}],\"coordinateTransformations\":[{\"type\":\"scale\","
       "\"scale\":"
       "[1,2,2]}],\"datasets\":[{\"path\":\"0\",\"coordinateTransformations\":[{\"type\":\"scale\",\"scale\":[1,3,5]},{"
       "\"type\":\"translation\",\"translation\":[0,1,1]}]},{\"path\":\"1\"},{\"path\":\"gone\"}]}]}"},
      {"0/.zarray", v2("[2,4,4]", "[1,4,4]", "|u1")},
      {"1/.zarray", v2("[2,2,2]", "[1,2,2]", "|u1")},
      {"labels/.zattrs", "{\"labels\":[\"cells\"]}"},
      {"labels/.zgroup", "{\"zarr_format\":2}"},
      {"labels/cells/.zattrs",
       "{\"image-label\":{},\"multiscales\":[{\"axes\":[{\"name\":\"y\"},{\"name\":\"x\"}],\"datasets\":[{\"path\":"
       "\"0\"}]}]"
       "}"},
      {"labels/cells/.zgroup", "{\"zarr_format\":2}"},
      {"labels/cells/0/.zarray", v2("[4,4]", "[4,4]", "<u4")}};
  for (const bool lists : {true, false}) {
    ZarrPlace place = place_of(files);
    if (!lists) place.list = nullptr;
    auto result = ZarrFile::open(place);
    REQUIRE(std::holds_alternative<std::shared_ptr<ZarrFile>>(result));
    const auto& images = std::get<std::shared_ptr<ZarrFile>>(result)->images();
    REQUIRE(images.size() == 2);
    REQUIRE(images[0].levels.size() == 2);
    CHECK(images[0].levels[0].scale == std::vector<double>{1, 6, 10});
    CHECK(images[0].levels[0].translation == std::vector<double>{0, 2, 2});
    CHECK(images[0].levels[0].path == "/0");
    CHECK_FALSE(images[0].labels);
    CHECK(images[1].labels);
    CHECK(images[1].levels[0].path == "/labels/cells/0");
  }
}

TEST_CASE("zarr: URLs of containers name the metadata files to try") {
  CHECK(zarr_entries_of_url("https://host/a/image.zarr?key=1").front() == "https://host/a/image.zarr/zarr.json?key=1");
  CHECK(zarr_entries_of_url("https://host/image.ome.ZARR/").at(1) == "https://host/image.ome.ZARR/.zgroup");
  CHECK(zarr_entries_of_url("https://host/image.zarr/scale0/image").size() == 5);
  CHECK(zarr_entries_of_url("https://host/image.zarr/zarr.json").empty());
  CHECK(zarr_entries_of_url("https://host/zarr/image.wrl").empty());
  CHECK(zarr_title_of("/data/image.zarr/zarr.json") == "image.zarr");
  CHECK(zarr_title_of("/data/brain.nii") == "brain.nii");
}

TEST_CASE("zarr: opens an array by its own metadata if its attributes name no format") {
  const std::string folder = (std::filesystem::temp_directory_path() / "ghostspace-zarr-attributes.zarr").string();
  std::filesystem::create_directories(folder);
  std::ofstream(folder + "/.zattrs") << "{\"units\": \"K\"}";
  CHECK(std::filesystem::path(zarr_entry_of_folder(folder)).filename() == ".zattrs");
  std::ofstream(folder + "/.zarray") << "{\"zarr_format\": 2}";
  CHECK(std::filesystem::path(zarr_entry_of_folder(folder)).filename() == ".zarray");
  std::filesystem::remove_all(folder);
}

/// Smallest number, largest number and mean of an array.
struct Facts {
  double least = std::numeric_limits<double>::infinity(), most = -least, mean = 0;
};
template <class T>
Facts facts_of(ZarrFile& file, std::size_t array) {
  Facts facts;
  const auto values = all_of<T>(file, array);
  for (const T value : values) {
    facts.least = std::min(facts.least, static_cast<double>(value));
    facts.most = std::max(facts.most, static_cast<double>(value));
    facts.mean += static_cast<double>(value) / static_cast<double>(values.size());
  }
  return facts;
}
Facts facts_of(ZarrFile& file, std::size_t array) {
  switch (file.arrays()[array].type) {
    case NumberType::u8:
      return facts_of<std::uint8_t>(file, array);
    case NumberType::i16:
      return facts_of<std::int16_t>(file, array);
    case NumberType::u16:
      return facts_of<std::uint16_t>(file, array);
    case NumberType::i32:
      return facts_of<std::int32_t>(file, array);
    case NumberType::f32:
      return facts_of<float>(file, array);
    case NumberType::f64:
      return facts_of<double>(file, array);
    default:
      break;
  }
  FAIL("a type that the list does not have");
  return {};
}

TEST_CASE("zarr: Arrays of other programs have the values that others read") {
  const char* const shared = std::getenv("GHOSTSPACE_SHARED");
  const std::filesystem::path folder =
      (shared ? std::filesystem::path(shared) : std::filesystem::path(GHOSTSPACE_TESTS "/../../shared")) / "data/zarr";
  std::ifstream list(folder / "README.md");
  if (!list) {
    WARN("skipped: no Zarr files in ../shared/data");
    return;
  }
  std::size_t checked = 0;
  for (std::string line; std::getline(list, line);) {
    // "| path/.zarray | 309 | ... | ... min 1 max 4 mean 2.5 |"
    const std::size_t least = line.rfind(" min "), end = line.find(" | ", 2);
    if (!line.starts_with("| ") || least == std::string::npos) continue;
    std::filesystem::path path = folder / line.substr(2, end - 2);
    std::istringstream numbers(line.substr(least));
    std::string word;
    Facts expected;
    numbers >> word >> expected.least >> word >> expected.most >> word >> expected.mean;
    REQUIRE(numbers);
    INFO(path.string());
    ZarrPlace place;
    place.read = files_beside(path.string(), {});
    auto result = ZarrFile::open(place);
    REQUIRE(std::holds_alternative<std::shared_ptr<ZarrFile>>(result));
    const auto file = std::get<std::shared_ptr<ZarrFile>>(result);
    REQUIRE(file->arrays().size() == 1);
    const Facts facts = facts_of(*file, 0);
    CHECK(facts.least == Approx(expected.least));
    CHECK(facts.most == Approx(expected.most));
    CHECK(facts.mean == Approx(expected.mean).margin(1e-4));
    CHECK(file->trouble().empty());
    ++checked;
  }
  CHECK(checked >= 50);
  auto mapped = net::map_file((folder / "ome/simple_0.5.zip").string());
  REQUIRE(std::holds_alternative<net::MappedFile>(mapped));
  auto place = zarr_place_of_zip(shared_bytes(std::move(std::get<net::MappedFile>(mapped))), own_budget());
  REQUIRE(std::holds_alternative<ZarrPlace>(place));
  auto zipped = ZarrFile::open(std::get<ZarrPlace>(place));
  REQUIRE(std::holds_alternative<std::shared_ptr<ZarrFile>>(zipped));
  const auto file = std::get<std::shared_ptr<ZarrFile>>(zipped);
  REQUIRE(file->images().size() == 1);
  CHECK(file->images().front().levels.size() == 3);
  CHECK(facts_of(*file, 0).mean == Approx(49.5));
}

}  // namespace
}  // namespace gs::app::zarr_test
