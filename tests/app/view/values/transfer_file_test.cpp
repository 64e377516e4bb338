#include "app/view/values/transfer_file.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <string>

namespace gs::app::transfer_file_test {
namespace {

TransferFile good(const std::string& text) {
  auto read = read_transfer_file(text, "t.json");
  if (auto* problem = std::get_if<std::string>(&read)) FAIL(*problem);
  return std::get<TransferFile>(read);
}

std::string problem(const std::string& text) {
  const auto read = read_transfer_file(text, "t.json");
  const auto* said = std::get_if<std::string>(&read);
  return said ? *said : std::string();
}

}  // namespace

TEST_CASE("restores a saved transfer function") {
  const Transfer transfer{{0, {10, 20, 30}, 0}, {0.25f, {255, 0, 128}, 0.125f}, {1, {1, 2, 3}, 1}};
  const std::pair<float, float> range{-1024, 3071};
  const TransferFile file = good(transfer_text(transfer, range, "HU"));
  CHECK(file.units == "HU");
  CHECK(file.has_values);
  const Transfer back = transfer_over(file, range);
  REQUIRE(back.size() == transfer.size());
  for (std::size_t i = 0; i < back.size(); ++i) {
    CHECK(back[i].value == Approx(transfer[i].value).margin(1e-6));
    CHECK(back[i].color == transfer[i].color);
    CHECK(back[i].opacity == transfer[i].opacity);
  }
}

TEST_CASE("keeps the values of a function in other data, and cuts it at their range") {
  const TransferFile file = good(
      R"({"range":[0,100],"points":[{"value":0,"color":[0,0,0],"opacity":0},{"value":100,"color":"#c86400","opacity":1}]})");
  const Transfer half = transfer_over(file, {25, 75});
  REQUIRE(half.size() == 2);
  CHECK(half[0].value == 0);
  CHECK(half[0].opacity == Approx(0.25f));
  CHECK(half[0].color == qnv::Rgb8{50, 25, 0});
  CHECK(half[1].opacity == Approx(0.75f));
  const Transfer wide = transfer_over(file, {-100, 300});
  REQUIRE(wide.size() == 2);
  CHECK(wide[0].value == Approx(0.25f));
  CHECK(wide[1].value == Approx(0.5f));
  const Transfer beyond = transfer_over(file, {200, 300});
  CHECK(transfer_at(beyond, 0.5f).opacity == 1);
}

TEST_CASE("scales a function without a range to the range of the data") {
  const TransferFile file = good(R"({"points":[{"value":0.5,"color":"#102030","opacity":0.5}]})");
  CHECK_FALSE(file.has_values);
  CHECK(transfer_over(file, {-5, 1000}).front().value == 0.5f);
  CHECK(transfer_over(file, {3, 3}).front().value == 0.5f);
}

TEST_CASE("rejects invalid transfer functions with their position and the expected text") {
  CHECK(problem("{\"points\":\n [}").starts_with("t.json:2:3: error: not JSON"));
  CHECK(problem("[]").find("expected an object with an array `points`") != std::string::npos);
  CHECK(problem(R"({"points":[]})").find("expected 1 to 64") != std::string::npos);
  CHECK(problem(R"({"points":[{"value":"a","color":"#000000","opacity":1}]})").find("points[0]: value: expected") !=
        std::string::npos);
  CHECK(problem(R"({"points":[{"value":1,"color":"#00000g","opacity":1}]})").find("color: expected") !=
        std::string::npos);
  CHECK(problem(R"({"points":[{"value":1,"color":[0,0,300],"opacity":1}]})").find("color: expected") !=
        std::string::npos);
  CHECK(problem(R"({"points":[{"value":1,"color":"#000000","opacity":2}]})").find("opacity: expected") !=
        std::string::npos);
  CHECK(problem(R"({"points":[{"value":1e999,"color":"#000000","opacity":0}]})").find("error") != std::string::npos);
  CHECK(problem(R"({"format":"x","points":[{"value":1,"color":"#000000","opacity":0}]})").find("format: expected") !=
        std::string::npos);
  CHECK(problem(R"({"range":[1],"points":[{"value":1,"color":"#000000","opacity":0}]})").find("range: expected") !=
        std::string::npos);
  CHECK(problem(std::string(2'000'000, ' ')).find("exceeds 1 MB") != std::string::npos);
  CHECK_FALSE(problem(std::string(100'000, '[')).empty());  // deep
  std::string many = R"({"points":[)";
  for (int i = 0; i < 65; ++i) many += std::string(i ? "," : "") + R"({"value":0,"color":"#000000","opacity":0})";
  CHECK(problem(many + "]}").find("expected 1 to 64") != std::string::npos);
}

TEST_CASE("rejects or reads every prefix of a file, and reads no further") {
  const std::string text = transfer_text({{0, {1, 2, 3}, 0.5f}, {1, {4, 5, 6}, 0.5f}}, {0, 1}, "K");
  for (std::size_t n = 0; n + 2 < text.size(); ++n) CHECK_FALSE(problem(text.substr(0, n)).empty());
}

}  // namespace gs::app::transfer_file_test
