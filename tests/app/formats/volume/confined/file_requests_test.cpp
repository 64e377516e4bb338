#include "app/formats/volume/confined/file_requests.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <map>
#include <string>
#include <vector>

namespace gs::app::file_requests_test {
namespace {

SharedBytes bytes_of(const std::string& text) {
  const auto bytes = std::as_bytes(std::span(text));
  return shared_bytes(std::vector<std::byte>(bytes.begin(), bytes.end()));
}
std::string text_of(const FileResult& result) {
  if (const auto* const bytes = std::get_if<SharedBytes>(&result))
    return {reinterpret_cast<const char*>(bytes->bytes.data()), bytes->bytes.size()};
  if (const auto* const problem = std::get_if<std::string>(&result)) return "problem " + *problem;
  return "none";
}

/// Files of the parent. Counts the calls.
struct Served {
  std::map<std::string, std::string> files{{"a/0.0", "first"}, {"b", "0123456789"}, {"empty", ""}};
  int calls = 0;

  ReadFiles read() {
    return [this](std::span<const FileRequest> requests) {
      ++calls;
      std::vector<FileResult> results;
      for (const FileRequest& request : requests) {
        const auto found = files.find(request.reference);
        if (request.reference == "locked")
          results.emplace_back(std::string("no permission"));
        else if (found == files.end())
          results.emplace_back(NoFile());
        else
          results.push_back(part_of(bytes_of(found->second), request.part));
      }
      return results;
    };
  }
};

TEST_CASE("file requests: A batch gets the same results through a parent as without one") {
  Served served;
  FileBatches batches(served.read(), [](const std::string& folder) -> std::optional<std::vector<std::string>> {
    if (folder != "a") return std::nullopt;
    return std::vector<std::string>{"0.0", "0.1"};
  });
  const ReadFile ask = [&](const std::string& text) -> BytesResult {
    REQUIRE(is_file_request(text));
    auto answer = batches.answer(text);
    REQUIRE(answer);
    return *answer;
  };
  const std::vector<FileRequest> requests{
      {"a/0.0"}, {"b", FilePart{2, 3}}, {"b", FilePart{0, 4, true}}, {"b", FilePart{8, 3}}, {"gone"}, {"locked"},
      {"empty"}};
  const auto results = files_by_asking(ask)(requests);
  REQUIRE(results.size() == requests.size());
  const auto direct = served.read()(requests);
  for (std::size_t i = 0; i < results.size(); ++i) CHECK(text_of(results[i]) == text_of(direct[i]));
  CHECK(text_of(results[1]) == "234");
  CHECK(text_of(results[2]) == "6789");
  CHECK(served.calls == 2);  // one of them direct
  CHECK(folders_by_asking(ask)("a") == std::vector<std::string>{"0.0", "0.1"});
  CHECK_FALSE(folders_by_asking(ask)("b"));
  CHECK(files_by_asking(ask)({}).empty());
  CHECK_FALSE(is_file_request("a/0.0"));
}

TEST_CASE("file requests: A child gets parts of its own file and no others") {
  Served served;
  std::vector<ByteSpan> needed;
  FileBatches batches(served.read(), nullptr, [&needed](std::span<const ByteSpan> parts) {
    needed.insert(needed.end(), parts.begin(), parts.end());
    return std::ranges::all_of(parts, [](const ByteSpan& part) { return part.offset + part.bytes <= 100; });
  });
  int asked = 0;
  const ReadFile ask = [&](const std::string& text) -> BytesResult {
    ++asked;
    auto answer = batches.answer(text);
    REQUIRE(answer);
    return *answer;
  };
  const NeedBytes need = parts_by_asking(ask);
  const std::vector<ByteSpan> parts{{0, 10}, {50, 50}, {20, 0}};
  CHECK(need(parts));
  CHECK(needed == std::vector<ByteSpan>{{0, 10}, {50, 50}});
  // The child does not request these parts again.
  CHECK(need(parts));
  CHECK(asked == 2);
  const ByteSpan behind{90, 20};
  CHECK_FALSE(need({&behind, 1}));
  CHECK_FALSE(need({&behind, 1}));
  FileBatches none(served.read(), nullptr);
  CHECK(std::holds_alternative<std::string>(*none.answer("|e|0|5|")));
  // A batch must not mix parts and other files.
  FileBatches mixed(served.read(), nullptr);
  CHECK(mixed.answer("|m|0|5|"));
  CHECK_FALSE(mixed.answer("|e|0|5|b"));
  // A child that ended in a batch does not disturb the next one.
  mixed.begin_child();
  CHECK(mixed.answer("|m|0|5|b"));
  CHECK(served.calls == 0);
}

TEST_CASE("file requests: Texts of hostile children are refused") {
  Served served;
  FileBatches batches(served.read(), nullptr);
  for (const char* const text :
       {"", "|", "||", "|e", "|e|", "|x|||b", "|e|1|b", "|e|||", "|e|e|5|", "|e|1||b", "|e||1|b",
        "|e|-1|1|b", "|e|1|z|b",
        "|e|18446744073709551615|2|b", "|e|99999999999999999999|2|b"}) {
    INFO(text);
    CHECK_FALSE(batches.answer(text));
  }
  CHECK(served.calls == 0);
  for (int i = 0; i < 4096; ++i) REQUIRE(batches.answer("|m|||b"));
  CHECK_FALSE(batches.answer("|m|||b"));
  FileBatches nothing(nullptr, nullptr);
  CHECK(std::holds_alternative<std::string>(*nothing.answer("|l|a")));
  CHECK(std::holds_alternative<SharedBytes>(*nothing.answer("|e|||a")));
}

}  // namespace
}  // namespace gs::app::file_requests_test
