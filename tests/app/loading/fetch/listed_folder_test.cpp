#include "app/loading/fetch/listed_folder.h"

#include "net/base/reference_policy.h"

#include <catch2/catch.hpp>

#include <cstdio>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace gs::app::listed_folder_test {
namespace {

/// Folder of 40 files on a server that counts requests.
struct CountedFolder {
  CountedFolder() {
    folder->bucket = net::parse_url("http://a/bucket/");
    for (int i = 0; i < 40; ++i) {
      char name[16];
      std::snprintf(name, sizeof name, "%02d.dcm", i);
      folder->names.emplace_back(name);
    }
  }
  [[nodiscard]] ReadFile reader() {
    return reader_of_listed(folder, [this](std::span<const WantedPart> wanted) {
      ++batches;
      std::vector<FileResult> results;
      for (const WantedPart& one : wanted) {
        const std::string url = one.url.text();
        ++requests[url];
        const auto text = std::as_bytes(std::span(url));
        results.push_back(shared_bytes(std::vector<std::byte>(text.begin(), text.end())));
      }
      return results;
    });
  }

  std::shared_ptr<ListedFolder> folder = std::make_shared<ListedFolder>();
  std::map<std::string, int> requests;  // by URL
  int batches = 0;
};

}  // namespace

TEST_CASE("listed folder: reads each file once in any order, and several ahead") {
  CountedFolder site;
  const ReadFile read = site.reader();
  std::vector<int> order{20, 5, 39, 0, 6, 21};
  for (int i = 39; i >= 0; --i) order.push_back(i);
  std::vector<bool> seen(40);
  for (const int i : order) {
    const auto at = static_cast<std::size_t>(i);
    if (seen[at]) continue;
    seen[at] = true;
    const BytesResult file = read(net::reference_of_path(site.folder->names[at]));
    REQUIRE(std::holds_alternative<SharedBytes>(file));
    const auto bytes = std::get<SharedBytes>(file).bytes;
    const std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    CHECK(text == site.folder->url_of(site.folder->names[at]).text());
  }
  CHECK(site.requests.size() == 40);
  for (const auto& [url, count] : site.requests) {
    INFO(url);
    CHECK(count == 1);
  }
  CHECK(site.batches < 12);
  // A file that was returned is requested again, because its bytes are not kept.
  CHECK(std::holds_alternative<SharedBytes>(read(net::reference_of_path(site.folder->names[3]))));
  CHECK(site.requests[site.folder->url_of(site.folder->names[3]).text()] == 2);
  CHECK(std::holds_alternative<std::string>(read("other.dcm")));
}

}  // namespace gs::app::listed_folder_test
