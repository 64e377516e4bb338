#include "app/loading/fetch/partial_file.h"

#include "app/loading/world_loader.h"
#include "qnv/sampling/volume/volume_values.h"
#include "tests/app/worlds.h"
#include "tests/net/memory_network.h"
#include "tests/qnv/value_streams.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

namespace gs::app {
namespace partial_file_test {
namespace {

constexpr std::uint32_t kWidth = 512, kSlices = 80;

/// NRRD file of 20 MB. Each voxel has the number of its slice, apart from a bright cube.
const std::vector<std::byte>& slices_file() {
  static const std::vector<std::byte> bytes = [] {
    const std::string head = "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 512 512 80\nencoding: raw\n\n";
    const auto first = std::as_bytes(std::span(head));
    std::vector<std::byte> all(first.begin(), first.end());
    for (std::uint32_t z = 0; z < kSlices; ++z)
      for (std::uint32_t y = 0; y < kWidth; ++y)
        for (std::uint32_t x = 0; x < kWidth; ++x)
          all.push_back(static_cast<std::byte>(x / 128 == 2 && y / 128 == 2 && z / 20 == 2 ? 200 : z));
    return all;
  }();
  return bytes;
}

net::MemoryResource slices_resource() {
  net::MemoryResource resource;
  resource.bytes = slices_file();
  resource.validator.etag = "\"1\"";
  return resource;
}

LoadOptions options_for(const std::shared_ptr<net::MemoryNetwork>& network) {
  LoadOptions options;
  options.memory = net::MakeMemoryTransport{network};
  options.timeout_seconds = 60;
  options.by_view = true;
  return options;
}

std::uint64_t asked_bytes(const net::MemoryNetwork& network, std::uint64_t total) {
  std::uint64_t asked = 0;
  for (const net::TransferRequest& transfer : network.transfers())
    asked += transfer.range ? std::min(transfer.range->end, total) - transfer.range->begin : total;
  return asked;
}

std::string texts_of(const Diagnostics& diagnostics) {
  std::string all;
  for (const Diagnostic& one : diagnostics.entries()) all += one.text() + "\n";
  return all;
}

/// File on the network, read by parts.
struct Remote {
  explicit Remote(net::MemoryNetwork::Answer answer) {
    network->put("memory://a/slices.nrrd", std::move(answer));
    net::LoaderOptions settings;
    settings.memory = net::MakeMemoryTransport{network};
    settings.max_retries = 0;
    settings.max_reconnects = 0;
    const auto served = std::make_shared<ServedFiles>(settings, own_budget());
    net::Validator validator;
    validator.etag = "\"1\"";
    file = std::make_unique<PartialFile>(
        "slices.nrrd",
        PartsOffer{{net::parse_url("memory://a/slices.nrrd"), {}, validator, slices_file().size()}, served},
        std::span(slices_file()).first(1000));
  }
  [[nodiscard]] bool need(std::uint64_t offset, std::uint64_t bytes) const {
    const ByteSpan part{offset, bytes};
    return file->need({&part, 1});
  }
  [[nodiscard]] std::vector<std::byte> content(std::uint64_t offset, std::size_t bytes) const {
    std::ifstream in(file->path(), std::ios::binary);
    in.seekg(static_cast<std::streamoff>(offset));
    std::vector<std::byte> read(bytes);
    in.read(reinterpret_cast<char*>(read.data()), static_cast<std::streamsize>(bytes));
    return read;
  }
  std::shared_ptr<net::MemoryNetwork> network = std::make_shared<net::MemoryNetwork>();
  std::unique_ptr<PartialFile> file;
};

net::MemoryNetwork::Answer slices_answer() {
  return [](const net::TransferRequest& request, unsigned) { return net::answer_well(slices_resource(), request); };
}

std::vector<std::byte> slices_part(std::uint64_t offset, std::size_t bytes) {
  const auto begin = slices_file().begin() + static_cast<std::ptrdiff_t>(offset);
  return {begin, begin + static_cast<std::ptrdiff_t>(bytes)};
}

}  // namespace

TEST_CASE("a partial file receives blocks that grow while reads follow each other") {
  const Remote remote(slices_answer());
  REQUIRE(remote.file->problem().empty());
  CHECK(remote.need(10, 100));
  CHECK(remote.network->transfers().empty());
  CHECK(remote.need(5'000'000, 10));
  CHECK(remote.network->transfers().size() == 1);
  CHECK(remote.file->received() == PartialFile::kLeastBlock);
  CHECK(remote.content(5'000'000, 10) == slices_part(5'000'000, 10));
  // Reading 8 MB in pieces takes few requests.
  for (std::uint64_t at = 5'000'010; at < 13'000'000; at += 8192) REQUIRE(remote.need(at, 8192));
  CHECK(remote.network->transfers().size() < 16);
  CHECK(remote.content(7'000'000, 5'000'000) == slices_part(7'000'000, 5'000'000));
  CHECK_FALSE(remote.need(slices_file().size() - 1, 2));
  CHECK_FALSE(remote.need(~std::uint64_t{0}, 2));
  CHECK(remote.need(slices_file().size() - 1, 1));
  CHECK(remote.file->trouble().empty());
}

TEST_CASE("a partial file receives several parts at once and none twice") {
  const Remote remote(slices_answer());
  std::vector<ByteSpan> parts;
  for (std::uint64_t at = 1'000'000; at < 9'000'000; at += 100'000) parts.push_back({at, 500});
  CHECK(remote.file->need(parts));
  CHECK(remote.file->received() < 80'000);
  const std::size_t transfers = remote.network->transfers().size();
  CHECK(transfers == parts.size());
  CHECK(remote.file->need(parts));
  CHECK(remote.network->transfers().size() == transfers);
  for (const ByteSpan& part : parts) CHECK(remote.content(part.offset, 500) == slices_part(part.offset, 500));
}

TEST_CASE("a partial file joins ranges with short gaps after requests have taken long for their bytes") {
  const Remote remote([](const net::TransferRequest& request, unsigned) {
    net::MemoryAnswer answer = net::answer_well(slices_resource(), request);
    answer.latency = net::Milliseconds(20);
    return answer;
  });
  const auto requests_of_parts = [&](std::uint64_t first) {
    std::vector<ByteSpan> parts;
    constexpr std::uint64_t kParts = 60, kGap = 9'500;
    for (std::uint64_t i = 0; i < kParts; ++i) parts.push_back({first + i * kGap, 100});
    const std::size_t before = remote.network->transfers().size();
    CHECK(remote.file->need(parts));
    return remote.network->transfers().size() - before;
  };
  REQUIRE(remote.need(0, 4'000'000));
  CHECK(requests_of_parts(5'000'000) == 60);
  CHECK(requests_of_parts(8'000'000) < 30);
}

TEST_CASE("a partial file reports a change on the server once and reads nothing more") {
  const Remote remote([](const net::TransferRequest& request, unsigned) {
    net::MemoryResource resource = slices_resource();
    resource.validator.etag = "\"2\"";
    return net::answer_well(resource, request);
  });
  CHECK_FALSE(remote.need(5'000'000, 10));
  CHECK_THAT(remote.file->trouble(), Catch::Contains("the file changed on the server; reload to get the new version"));
  const std::size_t transfers = remote.network->transfers().size();
  CHECK_FALSE(remote.need(6'000'000, 10));
  CHECK(remote.network->transfers().size() == transfers);
}

TEST_CASE("a partial file reports missing and truncated files, and reads on when the server answers again") {
  bool gone = true;
  const Remote remote([&gone](const net::TransferRequest& request, unsigned) {
    net::MemoryAnswer answer = net::answer_well(slices_resource(), request);
    if (gone) answer = {};
    if (gone) answer.head.status = 404;
    return answer;
  });
  CHECK_FALSE(remote.need(5'000'000, 10));
  CHECK_THAT(remote.file->trouble(), Catch::Contains("memory://a/slices.nrrd") && Catch::Contains("404"));
  gone = false;
  CHECK(remote.need(5'000'000, 10));
  const Remote shorter([](const net::TransferRequest& request, unsigned) {
    net::MemoryResource resource = slices_resource();
    resource.bytes.resize(4'000'000);
    return net::answer_well(resource, request);
  });
  CHECK_FALSE(shorter.need(5'000'000, 10));
  CHECK_FALSE(shorter.file->trouble().empty());
}

TEST_CASE("a volume on a server is shown without most of its bytes") {
  const auto network = std::make_shared<net::MemoryNetwork>();
  network->put("memory://a/slices.nrrd", slices_resource());
  const LoadedWorld world = load_world("memory://a/slices.nrrd", options_for(network));
  CHECK(texts_of(world.diagnostics).empty());
  const std::uint64_t asked = asked_bytes(*network, slices_file().size());
  CHECK(asked < slices_file().size() * 2 / 3);
  CHECK(world.received() == asked);
  REQUIRE(world.geometries.size() == 1);
  const auto* const volume = world.geometries.begin()->second->as<qnv::Volume>();
  REQUIRE(volume);
  REQUIRE(volume->values);
  const std::vector<float> values = test::values_in(volume->values->source);
  CHECK(*std::ranges::min_element(values) == 0);
  CHECK(*std::ranges::max_element(values) == 200);
}

TEST_CASE("a server without ranges sends the whole volume") {
  const auto network = std::make_shared<net::MemoryNetwork>();
  net::MemoryResource resource = slices_resource();
  resource.ranges = false;
  network->put("memory://a/slices.nrrd", resource);
  const LoadedWorld world = load_world("memory://a/slices.nrrd", options_for(network));
  CHECK(texts_of(world.diagnostics).empty());
  CHECK(world.geometries.size() == 1);
}

TEST_CASE("a volume that changes on its server gives one message") {
  const auto network = std::make_shared<net::MemoryNetwork>();
  network->put("memory://a/slices.nrrd", [](const net::TransferRequest& request, unsigned transfer) {
    net::MemoryResource resource = slices_resource();
    if (transfer > 2) resource.validator.etag = "\"2\"";
    return net::answer_well(resource, request);
  });
  const LoadedWorld world = load_world("memory://a/slices.nrrd", options_for(network));
  CHECK(world.diagnostics.entries().size() == 1);
  CHECK_THAT(texts_of(world.diagnostics), Catch::Contains("the file changed on the server"));
  CHECK(world.truncated);
}

TEST_CASE("a short volume on a server is read as a whole") {
  const auto network = std::make_shared<net::MemoryNetwork>();
  std::string text = "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 64 64 64\nencoding: raw\n\n";
  for (std::size_t i = 0; i < std::size_t{64} * 64 * 64; ++i)
    text += static_cast<char>(i % 64 > 20 && i / 64 % 64 > 20 ? 100 : 1);
  net::MemoryResource resource;
  const auto bytes = std::as_bytes(std::span(text));
  resource.bytes.assign(bytes.begin(), bytes.end());
  network->put("memory://a/short.nrrd", resource);
  const LoadedWorld world = load_world("memory://a/short.nrrd", options_for(network));
  CHECK(texts_of(world.diagnostics).empty());
  CHECK(world.geometries.size() == 1);
  CHECK(network->transfers().size() <= 2);
}

}  // namespace partial_file_test
}  // namespace gs::app
