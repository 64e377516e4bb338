#include "app/serve/index_rows.h"
#include "app/serve/archive_index.h"

#include <catch2/catch.hpp>

#include <string>
#include <vector>

using namespace gs;
using namespace gs::app;

namespace {

std::string joined(const std::vector<net::FolderEntry>& entries) {
  std::string text;
  for (const IndexRow& row : index_rows(entries)) {
    text += row.entry.name + ":" + std::to_string(row.entry.size);
    for (const net::FolderEntry& part : row.data) text += "+" + part.name;
    text += " ";
  }
  return text;
}

}  // namespace

TEST_CASE("an index shows a header and its data as one row with the size of both") {
  CHECK(joined({{"CThead.be.raw", false, 100, 0}, {"CThead.nhdr", false, 7, 0}}) == "CThead.nhdr:107+CThead.be.raw ");
  CHECK(joined({{"Box.gltf", false, 1, 0}, {"Box0.bin", false, 2, 0}, {"box1.bin", false, 3, 0}}) ==
        "Box.gltf:6+Box0.bin+box1.bin ");
  CHECK(joined({{"a.mhd", false, 1, 0}, {"a.raw.gz", false, 2, 0}}) == "a.mhd:3+a.raw.gz ");
  CHECK(joined({{"a.mtl", false, 1, 0}, {"a.obj", false, 2, 0}}) == "a.obj:3+a.mtl ");
  // Files without a header of their name keep their rows, as do folders.
  CHECK(joined({{"a.raw", false, 1, 0}, {"ab.nhdr", false, 2, 0}}) == "a.raw:1 ab.nhdr:2 ");
  CHECK(joined({{"a.raw", true, 0, 0}, {"a.nhdr", false, 2, 0}}) == "a.raw:0 a.nhdr:2 ");
  CHECK(joined({{".raw", false, 1, 0}, {".nhdr", false, 2, 0}, {"", false, 0, 0}}) == ".raw:1 .nhdr:2 :0 ");
  CHECK(joined({{"a.hdr", false, 1, 0}, {"a.nii.gz", false, 2, 0}}) == "a.hdr:1 a.nii.gz:2 ");
}

TEST_CASE("an index names the served folder, and finds a row by the name of its data") {
  net::FolderListing listing;
  listing.path = "/";
  listing.entries = {{"big.be.raw", false, 1000, 0}, {"big.nhdr", false, 100, 0}, {"x.stl", false, 1, 0}};
  const std::string page = archive_index(listing, {}, true, "my <models>").body;
  CHECK(page.find("<title>my &lt;models&gt;</title>") != std::string::npos);
  CHECK(page.find("<h1><a href=\"./\">my &lt;models&gt;</a></h1>") != std::string::npos);
  CHECK(page.find("2 entries") != std::string::npos);
  CHECK(page.find("1.1 kB") != std::string::npos);
  CHECK(page.find("+ <a href=\"./big.be.raw\" download>big.be.raw</a>") != std::string::npos);
  const std::string found = archive_index(listing, {false, "search=be.raw", {}}, true, "m").body;
  CHECK(found.find("big.nhdr") != std::string::npos);
  CHECK(found.find("x.stl") == std::string::npos);
  const std::string json = archive_index(listing, {true, {}, {}}, true, "m").body;
  CHECK(json.find("\"data\": [") != std::string::npos);
}
