#include "app/interface/base/places.h"

#include "tests/app/scratch_folder.h"

#include <catch2/catch.hpp>

#include <string>
#include <vector>

namespace gs::app::places_test {
namespace {

using Paths = std::vector<std::string>;

}  // namespace

TEST_CASE("completes a typed path as far as all matches agree") {
  const ScratchFolder scratch;
  for (const char* name : {"castle_north.wrl", "castle_south.wrl", "Tower/x.wrl", "notes.txt", ".hidden.wrl"})
    scratch.write(name, "x");
  const std::string folder = scratch.path("");
  FolderListing listing;
  CHECK(completed_path(folder + "c", listing) == folder + "castle_");
  CHECK(completed_path(folder + "castle_n", listing) == folder + "castle_north.wrl");
  CHECK(completed_path(folder + "to", listing) == folder + "Tower/");  // in any letter case
  CHECK(completed_path(folder + "n", listing) == folder + "n");        // notes.txt cannot be opened
  CHECK(completed_path("http://example.org/c", listing) == "http://example.org/c");
  CHECK(completed_path("", listing).empty());
  CHECK(suggested_paths(folder + "c", listing, 9) == Paths{folder + "castle_north.wrl", folder + "castle_south.wrl"});
  CHECK(suggested_paths(folder, listing, 9).front() == folder + "Tower/");  // folders first
  CHECK(suggested_paths(folder, listing, 9).size() == 3);                   // hidden files are missing
  CHECK(suggested_paths(folder + ".", listing, 9) == Paths{folder + ".hidden.wrl"});
  CHECK(suggested_paths(folder, listing, 2).size() == 2);
}

TEST_CASE("distinguishes typed paths, URLs and words") {
  CHECK(looks_like_path("/a"));
  CHECK(looks_like_path("~/a"));
  CHECK(looks_like_path("worlds/a"));
  CHECK_FALSE(looks_like_path("castle"));
  CHECK_FALSE(looks_like_path("http://example.org/a"));
  CHECK(looks_like_url("https://example.org/a.wrl"));
  CHECK(looks_like_url("ghostspace:http://example.org/a.wrl"));
  CHECK(looks_like_url("GhostSpace:http://example.org/a.wrl"));
  CHECK_FALSE(looks_like_url("C:/a"));
  CHECK(opened_path("  /a b ") == "/a b");
  CHECK(opened_path("   ").empty());
}

TEST_CASE("reports a folder that cannot be read") {
  FolderListing listing;
  CHECK(listing.entries_of("/nowhere/at/all").empty());
  CHECK_FALSE(listing.problem().empty());
}

}  // namespace gs::app::places_test
