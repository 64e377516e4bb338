#include "tests/app/volume_files.h"

using namespace gs;
using namespace gs::test;

namespace {

using Cards = std::vector<std::string>;

/// Returns the cards of an image of 3 x 2 x 2 bytes, with some omitted or replaced by `more`.
Cards byte_cube(const Cards& more = {}) {
  Cards cards = {"SIMPLE  = T", "BITPIX  = 8", "NAXIS   = 3", "NAXIS1  = 3", "NAXIS2  = 2", "NAXIS3  = 2"};
  for (const std::string& card : more) {
    const auto same = std::find_if(cards.begin(), cards.end(),
                                   [&](const std::string& c) { return c.substr(0, 8) == card.substr(0, 8); });
    same == cards.end() ? cards.push_back(card) : void(*same = card);
  }
  return cards;
}

/// Returns an extension with 3 x 2 x 2 bytes.
Cards extension(const std::string& type, const Cards& more = {}) {
  Cards cards = byte_cube(more);
  cards[0] = "XTENSION= '" + type + "'";
  return cards;
}

const Cards kNoData = {"SIMPLE  = T", "BITPIX  = 8", "NAXIS   = 0", "EXTEND  = T"};

struct Files {
  ScratchFolder folder;
  [[nodiscard]] std::string write(const std::string& content) const { return folder.write("a.fits", content); }
  [[nodiscard]] qnv::VolumeSource open(const std::string& content) const { return opened(write(content)); }
  [[nodiscard]] std::string problem(const std::string& content) const { return problem_of(write(content)); }
};

}  // namespace

TEST_CASE("refuses FITS headers with impossible axes, and names the error") {
  const Files files;
  const Bytes data = voxels<std::uint8_t>(true);
  const auto refused = [&](const Cards& more, const std::string& what) {
    const std::string problem = files.problem(fits(byte_cube(more), data));
    INFO(problem);
    CHECK(problem.find(what) != std::string::npos);
  };
  refused({"NAXIS   = -1"}, "NAXIS is -1; expected an integer from 0 to 999");
  refused({"NAXIS   = 1000"}, "NAXIS is 1000; expected");
  refused({"NAXIS   = 99999999999999999999"}, "NAXIS is 99999999999999999999; expected");
  refused({"NAXIS   = 3.0"}, "NAXIS is 3.0; expected");
  refused({"NAXIS   = 'x'"}, "NAXIS is 'x'; expected");
  refused({"NAXIS   ="}, "NAXIS is missing");
  for (const int axes : {4, 100, 999}) refused({"NAXIS   = " + std::to_string(axes)}, "NAXIS4 is missing; expected");
  refused({"NAXIS2  = -2"}, "NAXIS2 is -2; expected an integer of at least 0");
  refused({"NAXIS2  = two"}, "NAXIS2 is two; expected");
  refused({"NAXIS2  = 9223372036854775808"}, "NAXIS2 is 9223372036854775808; expected");
  refused({"NAXIS1  = 9223372036854775807"}, "too long for a file");
  refused({"NAXIS1  = 4294967296", "NAXIS2  = 4294967296"}, "too long for a file");
  refused({"NAXIS1  = 4294967295", "NAXIS2  = 1", "NAXIS3  = 1"}, "need");
  refused({"NAXIS1  = 4294967296", "NAXIS2  = 1", "NAXIS3  = 1"}, "longer than 4294967295");
  refused({"BITPIX  = -64", "NAXIS1  = 2147483648", "NAXIS2  = 1073741824"}, "too long for a file");
  for (const char* bits : {"0", "1", "-8", "-16", "24", "128", "9223372036854775807", "8.0"})
    refused({std::string("BITPIX  = ") + bits}, std::string("BITPIX is ") + bits + "; expected 8, 16");
  refused({"BITPIX  "}, "BITPIX is missing");
}

TEST_CASE("opens FITS files of a hundred axes if only three are longer than 1") {
  const Files files;
  for (const int count : {100, 999}) {
    Cards cards = byte_cube({"NAXIS   = " + std::to_string(count)});
    for (int i = 4; i <= count; ++i) {
      std::string keyword = "NAXIS" + std::to_string(i);
      keyword.resize(8, ' ');
      cards.push_back(keyword + "= 1");
    }
    check_values(files.open(fits(cards, voxels<std::uint8_t>(true))));
    cards.back() = "NAXIS" + std::to_string(count) + "= 2";
    CHECK(files.problem(fits(cards, voxels<std::uint8_t>(true))).find("4 axes are longer than 1") != std::string::npos);
  }
}

TEST_CASE("survives FITS headers without END and with invalid cards") {
  const Files files;
  std::string whole = fits(byte_cube(), voxels<std::uint8_t>(true));
  whole.replace(whole.find("END "), 3, "XND");
  CHECK(files.problem(whole).find("END") != std::string::npos);
  CHECK(files.problem("SIMPLE  =").find("END") != std::string::npos);
  CHECK(files.problem("SIMPLE  =" + std::string(71, 'T')).find("END") != std::string::npos);
  CHECK(files.problem("SIMPLE  =" + std::string(std::size_t{12} << 20, ' ')).find("END among") != std::string::npos);
  CHECK(files.problem(fits({"SIMPLE  = T"}, {})).find("BITPIX is missing") != std::string::npos);
  // A card has a value only with '=' in its ninth column (4.1.2).
  CHECK(files.problem(fits(byte_cube({"NAXIS    3"}), {})).find("NAXIS is missing") != std::string::npos);
  const Cards strange = byte_cube({"", "COMMENT = 5", "HISTORY", "=", "'", "BSCALE   7", "BSCALEX = 7", "BLANK   ",
                                   "NAXIS0  = 9", "NAXIS-1 = 9", "NAXIS1X = 9", "BZERO   = 'unterminated",
                                   "HIERARCH ESO DET = 4", std::string(80, '\xff'), std::string(80, '\0')});
  check_values(files.open(fits(strange, voxels<std::uint8_t>(true))));
  // If a card occurs twice, the first one applies.
  Cards twice = byte_cube({"BSCALE  = 2"});
  twice.insert(twice.end(), {"BSCALE  = 3", "NAXIS1  = 300", "BITPIX  = 16"});
  check_values(files.open(fits(twice, voxels<std::uint8_t>(true))), 2);
}

TEST_CASE("parses values of FITS cards as the standard defines") {
  const Files files;
  const auto scaled = [&](const std::string& value) {
    return files.open(fits(byte_cube({"BSCALE  =" + value}), voxels<std::uint8_t>(true))).layout.slope;
  };
  CHECK(scaled("                  2.5") == 2.5);
  CHECK(scaled(" 2.5 / 7") == 2.5);
  CHECK(scaled(" 2.5/7") == 2.5);
  CHECK(scaled(" +.25D+2") == 25);
  CHECK(scaled(" -1.E2") == -100);
  CHECK(scaled(" '2.5     ' / quoted") == 2.5);
  for (const char* none : {" 'many'", " 1e999", " nan", " inf", " T", " (1, 2)", " 1.5.2", " 0x10", "", " / 7"})
    CHECK(scaled(none) == 1);
  const auto title = [&](const Cards& more) {
    const auto metadata = files.open(fits(byte_cube(more), voxels<std::uint8_t>(true))).layout.metadata;
    return metadata.empty() ? "" : metadata[0].second;
  };
  CHECK(title({"OBJECT  = 'Barnard''s / star  ' / name"}) == "Barnard's / star");
  CHECK(title({"OBJECT  = ''"}).empty());
  CHECK(title({"OBJECT  = '''"}) == "'");
  CHECK(title({"OBJECT  = 'no end"}) == "no end");
  CHECK(title({"OBJECT  = 'long&'", "CONTINUE  'er'"}) == "long");
  CHECK(title({"OBJECT  = 'R&D&'"}) == "R&D&");
}

TEST_CASE("reads unsigned and scaled FITS integers") {
  const Files files;
  const auto first_values = [&](int bits, const Bytes& data, const Cards& more) {
    Cards cards = byte_cube({"BITPIX  = " + std::to_string(bits)});
    cards.insert(cards.end(), more.begin(), more.end());
    return values_of(files.open(fits(cards, data)));
  };
  // 4.4.2.5, table 11: unsigned integers are stored with the highest bit inverted.
  const auto stored = [](auto first, auto second) {
    Bytes data;
    put_big(data, first);
    put_big(data, second);
    data.resize(12 * sizeof(first));
    return data;
  };
  auto values = first_values(16, stored(std::int16_t{-32768}, std::int16_t{32767}), {"BZERO   = 32768"});
  CHECK((values[0] == 0 && values[1] == 65535));
  values = first_values(32, stored(std::int32_t{-2147483647 - 1}, std::int32_t{2147483647}), {"BZERO   = 2147483648"});
  CHECK((values[0] == 0 && values[1] == 4294967295.0f));
  values = first_values(64, stored(std::numeric_limits<std::int64_t>::min(), std::int64_t{0}),
                        {"BZERO   = 9223372036854775808"});
  CHECK((values[0] == 0 && values[1] == 9223372036854775808.0f));
  values = first_values(8, stored(std::uint8_t{0}, std::uint8_t{255}), {"BZERO   = -128"});
  CHECK((values[0] == -128 && values[1] == 127));
  // BLANK is a stored integer, before scaling.
  values = first_values(16, stored(std::int16_t{-9}, std::int16_t{9}), {"BLANK   = -9", "BZERO   = 5"});
  CHECK((std::isnan(values[0]) && values[1] == 14));
  values = first_values(-32, stored(-9.0f, 9.0f), {"BLANK   = -9"});
  CHECK((values[0] == -9 && values[1] == 9));
}

TEST_CASE("skips data before the first FITS image") {
  const Files files;
  const Bytes data = voxels<std::uint8_t>(true);
  const std::string image = fits(extension("IMAGE   "), data);
  check_values(files.open(fits(kNoData, {}) + image));
  // A table and its heap together take more than one block (3.3, equation 2).
  check_values(files.open(
      fits(kNoData, {}) +
      fits(extension("BINTABLE", {"NAXIS   = 2", "NAXIS1  = 30", "NAXIS2  = 100", "PCOUNT  = 2761", "TFIELDS = 999"}),
           Bytes(5761)) +
      image));
  check_values(files.open(fits(kNoData, {}) + fits(extension("TABLE   ", {"GCOUNT  = 240"}), Bytes(2880)) + image));
  check_values(files.open(fits(kNoData, {}) + fits(extension("FOREIGN ", {"NAXIS1  = 0"}), {}) + image));
  // Random groups: three of two parameters and 2 x 2 values of two bytes (6.1.1).
  const Cards groups = byte_cube({"BITPIX  = 16", "NAXIS1  = 0", "GROUPS  = T", "PCOUNT  = 2", "GCOUNT  = 3"});
  check_values(files.open(fits(groups, Bytes(36)) + image));
  // An axis of length 0 means no data (4.4.1.1). A primary array has groups only with GROUPS = T.
  check_values(files.open(fits(byte_cube({"NAXIS1  = 0", "PCOUNT  = 9"}), {}) + image));
  check_values(files.open(fits(byte_cube({"GCOUNT  = 7"}), data)));

  CHECK(files.problem(fits(kNoData, {}) + fits(extension("IMAGE   ", {"GCOUNT  = 2"}), data + data))
            .find("GCOUNT is 2") != std::string::npos);
  for (const char* compressed : {"T", "                   T / tiles"}) {
    const std::string problem = files.problem(
        fits(kNoData, {}) + fits(extension("BINTABLE", {std::string("ZIMAGE  = ") + compressed}), data) + image);
    CHECK(problem.find("funpack") != std::string::npos);
  }
  CHECK(files.problem(fits(kNoData, {}) + std::string(2880, 'x')).find("no image") != std::string::npos);
}

TEST_CASE("ends on FITS units that lead nowhere") {
  const Files files;
  const std::string none = fits(kNoData, {});
  const auto refused = [&](const std::string& content, const std::string& what) {
    const std::string problem = files.problem(content);
    INFO(problem);
    CHECK(problem.find(what) != std::string::npos);
  };
  // Sizes that overflow or lead backwards are checked before they are added.
  for (const char* count : {"9223372036854775807", "-2880", "-1", "18446744073709548736", "1e3"}) {
    refused(none + fits(extension("BINTABLE", {std::string("PCOUNT  = ") + count}), {}) + none,
            count[0] == '9' ? "too long for a file" : "PCOUNT is");
    refused(none + fits(extension("BINTABLE", {std::string("GCOUNT  = ") + count}), {}) + none,
            count[0] == '9' ? "too long for a file" : "GCOUNT is");
  }
  refused(none + fits(extension("BINTABLE", {"PCOUNT  = 9223372036854772900"}), {}) + none, "too long for a file");
  refused(none + fits(extension("BINTABLE", {"NAXIS1  = 0", "PCOUNT  = 4611686018427387904"}), {}) + none, "no image");
  refused(none + fits(extension("BINTABLE", {"NAXIS1  = 1000"}), {}), "no image");
  std::string many = none;
  for (int i = 0; i < 1100; ++i) many += fits(extension("TABLE   ", {"NAXIS   = 0"}), {});
  refused(many, "no image among its first 1000 headers");
  // Long consecutive headers.
  Cards comments = extension("TABLE   ");
  comments.insert(comments.end(), 20000, "COMMENT");
  std::string longer = none;
  while (longer.size() < std::size_t{16} << 20) longer += fits(comments, Bytes(12));
  refused(longer, "no END among");
}

TEST_CASE("survives every prefix of a FITS file with several units") {
  const Files files;
  const std::string whole = fits(kNoData, {}) + fits(extension("BINTABLE", {"PCOUNT  = 3000"}), Bytes(3012)) +
                            fits(extension("IMAGE   ", {"BITPIX  = 16"}), voxels<std::int16_t>(true));
  check_values(files.open(whole));
  for (std::size_t n = 0; n <= whole.size(); n += n % 80 < 2 || n % 80 == 79 ? 1 : 39) {
    const std::string path = files.write(whole.substr(0, n));
    check_sound(path);
    const std::size_t needed = whole.size() - 2880 + 24;
    CHECK(problem_of(path).empty() == (n >= needed));
  }
}
