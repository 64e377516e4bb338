#include "app/loading/listing/bucket_list.h"

#include "app/loading/listing/folder_choice.h"
#include "app/loading/world_loader.h"
#include "tests/app/geometry_shapes.h"
#include "tests/app/worlds.h"
#include "tests/net/memory_network.h"

#include <catch2/catch.hpp>

#include <map>
#include <memory>
#include <random>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace gs::app::bucket_list_test {
namespace {

using Page = std::variant<BucketPage, std::string>;

Page page_of(const std::string& text) { return read_bucket_page(test::bytes_of(text), own_budget()); }

std::string list_text(const std::string& content) {
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
         "<ListBucketResult xmlns=\"http://s3.amazonaws.com/doc/2006-03-01/\"><Name>bucket</Name>" +
         content + "</ListBucketResult>";
}

/// Bucket at memory://store/bucket with lists of few keys per page.
class Store {
 public:
  static constexpr std::size_t kKeysOfPage = 3;

  void put(const std::string& key, const std::string& text) {
    keys_[key] = text;
    net::MemoryResource resource;
    resource.bytes = test::bytes_of(text);
    network->put("memory://store/bucket/" + key, std::move(resource));
  }
  /// Serves the list of a prefix, page by page.
  void list(const std::string& prefix, bool folders) {
    std::vector<std::string> entries;
    std::set<std::string> seen;
    for (const auto& [key, text] : keys_) {
      if (!key.starts_with(prefix)) continue;
      const std::size_t slash = key.find('/', prefix.size());
      if (!folders || slash == std::string::npos)
        entries.push_back("<Contents><Key>" + key + "</Key><Size>1</Size></Contents>");
      else if (seen.insert(key.substr(0, slash + 1)).second)
        entries.push_back("<CommonPrefixes><Prefix>" + key.substr(0, slash + 1) + "</Prefix></CommonPrefixes>");
    }
    const BucketPlace place{net::parse_url("memory://store/bucket/"), prefix};
    net::Url url = list_url(place, folders);
    for (std::size_t begin = 0; begin == 0 || begin < entries.size(); begin += kKeysOfPage) {
      std::string text = "<Prefix>" + prefix + "</Prefix>";
      for (std::size_t i = begin; i < std::min(begin + kKeysOfPage, entries.size()); ++i) text += entries[i];
      const bool more = begin + kKeysOfPage < entries.size();
      const std::string token = "t/" + std::to_string(begin) + "=";
      text += more ? "<IsTruncated>true</IsTruncated><NextContinuationToken>" + token + "</NextContinuationToken>" : "";
      net::MemoryResource resource;
      resource.bytes = test::bytes_of(list_text(text));
      network->put(url.text(), std::move(resource));
      if (!more) return;
      url = next_list_url(url, std::get<BucketPage>(page_of(list_text(text))).next);
    }
  }
  [[nodiscard]] LoadedWorld load(const std::string& url, std::optional<qnv::ShownStep> step = std::nullopt) const {
    LoadOptions options;
    options.memory = net::MakeMemoryTransport{network};
    options.timeout_seconds = 60;
    options.component.step = step;
    return load_world(url, options);
  }
  [[nodiscard]] bool was_asked_for(std::string_view part) const {
    const auto all = network->transfers();
    return std::ranges::any_of(all, [&](const auto& one) { return one.url.find(part) != std::string::npos; });
  }
  std::shared_ptr<net::MemoryNetwork> network = std::make_shared<net::MemoryNetwork>();

 private:
  std::map<std::string, std::string> keys_;
};

std::string boxes(std::size_t count) {
  std::string text = "#VRML V2.0 utf8\n";
  for (std::size_t i = 0; i < count; ++i) text += "Shape { geometry Box { } }\n";
  return text;
}

void put_array(Store& store, const std::string& folder, char value) {
  store.put(folder + ".zarray", R"({"zarr_format": 2, "shape": [4, 4, 4], "chunks": [4, 4, 4], "dtype": "|u1",
    "compressor": null, "fill_value": 0, "order": "C", "filters": null})");
  std::string voxels(64, value);
  voxels[21] = 100;
  store.put(folder + "0.0.0", voxels);
}

}  // namespace

TEST_CASE("reads pages of lists of buckets of both versions") {
  CHECK(is_bucket_list(test::bytes_of(list_text(""))));
  CHECK_FALSE(is_bucket_list(test::bytes_of("<Error><Code>NoSuchKey</Code></Error>")));
  CHECK_FALSE(is_bucket_list(test::bytes_of("{\"ListBucketResult\": \"<ListBucketResult\"}")));
  const Page second = page_of(list_text(
      "<Prefix>run/</Prefix><IsTruncated>true</IsTruncated><NextContinuationToken>a+b/=</NextContinuationToken>"
      "<Contents><Key>run/a &amp; b.qnv</Key><Owner><ID>7</ID></Owner></Contents>"
      "<CommonPrefixes><Prefix>run/more/</Prefix></CommonPrefixes>"));
  REQUIRE(std::holds_alternative<BucketPage>(second));
  const BucketPage& page = std::get<BucketPage>(second);
  CHECK(page.prefix == "run/");
  CHECK(page.keys == std::vector<std::string>{"run/a & b.qnv"});
  CHECK(page.folders == std::vector<std::string>{"run/more/"});
  CHECK(page.next == "continuation-token=a%2Bb%2F%3D");
  const auto next_of = [](const std::string& content) {
    return std::get<BucketPage>(page_of(list_text(content))).next;
  };
  const std::string key = "<IsTruncated>true</IsTruncated><Contents><Key>k 1</Key></Contents>";
  CHECK(next_of(key) == "marker=k%201");
  CHECK(next_of(key + "<NextMarker>m/</NextMarker>") == "marker=m%2F");
  CHECK(next_of("<Contents><Key>k 1</Key></Contents>").empty());
  const Page encoded =
      page_of(list_text("<EncodingType>url</EncodingType><Contents><Key>a+%2B%C3%A4</Key></Contents>"));
  CHECK(std::get<BucketPage>(encoded).keys == std::vector<std::string>{"a +\xc3\xa4"});
}

TEST_CASE("refuses hostile lists of buckets") {
  for (const char* const text : {"", "<a/>", "<ListBucketResult>", "<ListBucketResult><Contents></ListBucketResult>"})
    CHECK(std::holds_alternative<std::string>(page_of(text)));
  std::string deep;
  for (int i = 0; i < 5000; ++i) deep += "<a>";
  CHECK(std::holds_alternative<std::string>(page_of("<ListBucketResult>" + deep)));
  // Entities that expand to gigabytes.
  std::string bomb = "<!DOCTYPE a [<!ENTITY l0 \"0123456789\">";
  for (int i = 1; i < 10; ++i) {
    bomb += "<!ENTITY l" + std::to_string(i) + " \"";
    for (int k = 0; k < 10; ++k) bomb += "&l" + std::to_string(i - 1) + ";";
    bomb += "\">";
  }
  CHECK(
      std::holds_alternative<std::string>(page_of(bomb + "]><ListBucketResult><Name>&l9;</Name></ListBucketResult>")));
  std::string many;
  for (int i = 0; i < 10'001; ++i) many += "<Contents><Key>k</Key></Contents>";
  CHECK(std::holds_alternative<std::string>(page_of(list_text(many))));
  // A key longer than stores permit is left out.
  const Page page = page_of(list_text("<Contents><Key>" + std::string(5000, 'k') + "</Key></Contents>"));
  CHECK(std::get<BucketPage>(page).keys.empty());
  std::mt19937 random(5);
  const std::string good = list_text("<IsTruncated>true</IsTruncated><Contents><Key>a/b</Key></Contents>");
  for (int round = 0; round < 300; ++round) {
    std::string spoilt = good;
    spoilt[random() % spoilt.size()] = static_cast<char>(random());
    (void)page_of(spoilt.substr(0, random() % 2 == 0 ? spoilt.size() : random() % spoilt.size()));
  }
}

TEST_CASE("finds the bucket of a folder in its path or in its host") {
  const auto urls = [](const std::string& url) {
    std::vector<std::string> all;
    for (const BucketPlace& place : bucket_places(net::parse_url(url))) all.push_back(list_url(place, true).text());
    return all;
  };
  CHECK(urls("https://s3.example.org/b/run%207/") ==
        std::vector<std::string>{"https://s3.example.org/b?list-type=2&delimiter=%2F&prefix=run%207%2F",
                                 "https://s3.example.org/?list-type=2&delimiter=%2F&prefix=b%2Frun%207%2F"});
  CHECK(urls("https://b.s3.example.org/run/") ==
        std::vector<std::string>{"https://b.s3.example.org/?list-type=2&delimiter=%2F&prefix=run%2F",
                                 "https://b.s3.example.org/run?list-type=2&delimiter=%2F&prefix="});
  CHECK(urls("https://b.s3.example.org/") ==
        std::vector<std::string>{"https://b.s3.example.org/?list-type=2&delimiter=%2F&prefix="});
  for (const char* const url :
       {"ftp://a/b/", "ssh://a/b/", "/b/", "https://u:p@a/b/", "https://a/b/?X-Amz-Signature=7"})
    CHECK(urls(url).empty());
  BucketPage page;
  page.prefix = "run/";
  const BucketPlace place = place_of_list(net::parse_url("https://s3.example.org/b?list-type=2&prefix=run/"), page);
  CHECK(object_url(place.bucket, "run/a b.qnv").text() == "https://s3.example.org/b/run/a%20b.qnv");
  CHECK(next_list_url(net::parse_url("https://a/b?marker=x&prefix=y"), "marker=z").text() ==
        "https://a/b?prefix=y&marker=z");
}

TEST_CASE("chooses the file that represents a folder") {
  using Names = std::vector<std::string>;
  const auto choice = [](const Names& names, const std::string& series = {}, std::optional<qnv::ShownStep> step = {}) {
    return choose_in_folder(names, series.empty() ? std::nullopt : numbered_name(series), step);
  };
  const auto file = [&](const auto&... all) {
    const auto chosen = choice(all...);
    return std::holds_alternative<FolderChoice>(chosen) ? std::get<FolderChoice>(chosen).files.front() : std::string();
  };
  CHECK(file(Names{".zattrs", ".zgroup", "a/.zarray"}) == ".zgroup");
  CHECK(file(Names{"README.md", "s/1", "s/2"}) == "s/1");
  CHECK(std::get<FolderChoice>(choice(Names{"a.txt", "ct/0001.dcm", "ct/0002.dcm"})).is_scan);
  CHECK(file(Names{"README", "ct/1.dcm"}) == "ct/1.dcm");
  CHECK(file(Names{"notes.md", "a.qnv"}) == "a.qnv");
  CHECK(file(Names{"a.qnv", "b.qnv"}).empty());
  CHECK(file(Names{}).empty());
  CHECK(file(Names{"r1.qnv", "r10.qnv", "r2.qnv", "rx.qnv"}, "r%d.qnv", qnv::ShownStep{1, {}}) == "r2.qnv");
  CHECK(file(Names{"x.qnv"}, "r%d.qnv").empty());
  CHECK(series_of_url("https://a/b/run.%04d.qnv")->before == "run.");
  CHECK_FALSE(series_of_url("https://a/b/run.%20.qnv"));
  CHECK_FALSE(series_of_url("run.%04d.qnv"));
}

TEST_CASE("opens one step of a series of numbered files in a bucket, from a list of several pages") {
  Store store;
  for (std::size_t i = 0; i < 8; ++i) store.put("run/s" + std::to_string(i * 5) + ".wrl", boxes(i + 1));
  store.put("run/other.wrl", boxes(20));
  store.list("run/s", true);
  const LoadedWorld first = store.load("memory://store/bucket/run/s%02d.wrl");
  CHECK(said(first).empty());
  REQUIRE(first.scene);
  CHECK(first.scene->roots().size() == 1);
  CHECK(first.steps == TimeSteps{{0, 5, 10, 15, 20, 25, 30, 35}, 0});
  const LoadedWorld sixth = store.load("memory://store/bucket/run/s%02d.wrl", qnv::ShownStep{0, 25.0});
  REQUIRE(sixth.scene);
  CHECK(sixth.scene->roots().size() == 6);
  const LoadedWorld none = store.load("memory://store/bucket/missing/s%d.wrl");
  CHECK_FALSE(none.scene);
  CHECK(none.diagnostics.errors() == 1);
}

TEST_CASE("opens a group of Zarr in a bucket without consolidated metadata") {
  Store store;
  store.put("data.zarr/.zgroup", R"({"zarr_format": 2})");
  put_array(store, "data.zarr/density/", 7);
  put_array(store, "data.zarr/inner/pressure/", 9);
  store.put("data.zarr/inner/.zgroup", R"({"zarr_format": 2})");
  store.list("data.zarr/", true);
  store.list("data.zarr/inner/", true);
  const LoadedWorld world = store.load("memory://store/bucket/data.zarr");
  CHECK(world.diagnostics.entries().size() == 1);
  CHECK_THAT(said(world), Catch::Contains("shows /density, one of 2 datasets"));
  CHECK(world.geometries.size() == 1);
  CHECK(store.was_asked_for("data.zarr/density/0.0.0"));
  CHECK(store.was_asked_for("data.zarr/inner/pressure/.zarray"));
  // A URL with a slash at its end names a folder with any content.
  Store plain;
  plain.put("run7/.zgroup", R"({"zarr_format": 2})");
  put_array(plain, "run7/density/", 7);
  plain.list("run7/", true);
  plain.list("run7/", false);
  CHECK(plain.load("memory://store/bucket/run7/").geometries.size() == 1);
}

TEST_CASE("gives one message for a folder that no server lists, and for a list without an end") {
  Store store;
  const LoadedWorld none = store.load("memory://store/bucket/run/");
  CHECK(none.diagnostics.errors() == 1);
  CHECK(said(none).find("404") != std::string::npos);
  net::MemoryResource resource;
  resource.bytes = test::bytes_of(
      list_text("<Prefix>run/</Prefix><IsTruncated>true</IsTruncated><NextContinuationToken>t</NextContinuationToken>"
                "<Contents><Key>run/a.wrl</Key></Contents>"));
  const BucketPlace place{net::parse_url("memory://store/bucket/"), "run/"};
  const net::Url url = list_url(place, false);
  store.network->put(url.text(), resource);
  store.network->put(next_list_url(url, "continuation-token=t").text(), resource);
  store.put("run/a.wrl", boxes(2));
  const LoadedWorld endless = store.load("memory://store/bucket/run/");
  CHECK(said(endless).find("the list has no end") != std::string::npos);
  REQUIRE(endless.scene);
  CHECK(endless.scene->roots().size() == 2);
}

}  // namespace gs::app::bucket_list_test
