#include "bench/transfer/options.h"

#include "bench/transfer/run.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <functional>
#include <optional>
#include <string_view>

namespace gs::bench {
namespace {

using Problem = std::optional<std::string>;

std::vector<std::string_view> split(std::string_view text) {
  std::vector<std::string_view> parts;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    parts.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return parts;
}

std::optional<std::vector<double>> numbers(std::string_view text, double least, double most) {
  std::vector<double> all;
  for (const std::string_view part : split(text)) {
    double number = 0;
    const auto read = std::from_chars(part.data(), part.data() + part.size(), number);
    if (read.ec != std::errc() || read.ptr != part.data() + part.size() || !(number >= least && number <= most))
      return std::nullopt;
    all.push_back(number);
  }
  return all;
}

Problem set_list(std::vector<double>& list, std::string_view text, double least, double most) {
  const auto all = numbers(text, least, most);
  if (!all) return "expected numbers with commas between";
  list = *all;
  return {};
}

template <class Number>
Problem set_number(Number& number, std::string_view text, double least, double most) {
  const auto all = numbers(text, least, most);
  if (!all || all->size() != 1) return "expected a number";
  number = static_cast<Number>(all->front());
  return {};
}

// A name selects the format of this name, and all formats that begin with the name and a dash.
Problem set_formats(std::vector<const Format*>& formats, std::string_view text) {
  formats.clear();
  for (const std::string_view name : split(text)) {
    const std::size_t before = formats.size();
    for (const Format& format : kFormats)
      if (format.name == name || format.name.starts_with(std::string(name) + "-")) formats.push_back(&format);
    if (formats.size() == before) return "there is no format " + std::string(name);
  }
  return {};
}

Problem set_view(View& view, std::string_view text) {
  const auto all = numbers(text, -3600, 3600);
  if (!all || all->size() != 2) return "expected AZIMUTH,ELEVATION in degrees";
  view = {static_cast<float>((*all)[0]), static_cast<float>((*all)[1])};
  return {};
}

Problem set_tables(TransferOptions& options, std::string_view text) {
  options.matrix = options.loss = false;
  for (const std::string_view name : split(text)) {
    if (name == "matrix")
      options.matrix = true;
    else if (name == "loss")
      options.loss = true;
    else if (name != "archive" && name != "bytes")
      return "expected some of bytes,matrix,loss,archive";
  }
  return {};
}

/// One option with a value.
struct Option {
  std::string_view name;
  std::function<Problem(std::string_view)> set;
};

std::vector<Option> table(TransferOptions& options) {
  constexpr double kMany = 1e9;
  const auto text = [](std::string& to) {
    return [&to](std::string_view value) {
      to = value;
      return Problem{};
    };
  };
  return {
      {"--model", text(options.model.file)},
      {"--program", text(options.program)},
      {"--archive", text(options.archive)},
      {"--congestion", text(options.congestion)},
      {"--tcp", text(options.tcp)},
      {"--rates", [&](auto value) { return set_list(options.rates, value, 0.01, 1000); }},
      {"--rtts", [&](auto value) { return set_list(options.round_trips, value, 0, 10'000); }},
      {"--losses", [&](auto value) { return set_list(options.losses, value, 0, 100); }},
      {"--formats", [&](auto value) { return set_formats(options.formats, value); }},
      {"--tables", [&](auto value) { return set_tables(options, value); }},
      {"--orbit", [&](auto value) { return set_view(options.model.view, value); }},
      {"--limit", [&](auto value) { return set_number(options.limit, value, 0, 3600); }},
      {"--parallel", [&](auto value) { return set_number(options.parallel, value, 1, 64); }},
      {"--runs", [&](auto value) { return set_number(options.runs, value, 1, 99); }},
      {"--seed", [&](auto value) { return set_number(options.seed, value, 0, kMany); }},
      {"--tolerance", [&](auto value) { return set_number(options.model.tolerance, value, 0, 1); }},
      {"--draco-bits", [&](auto value) { return set_number(options.model.draco_bits, value, 1, 30); }},
      {"--packed-bytes", [&](auto value) { return set_number(options.model.packed_bytes, value, 0, kMany); }},
      {"--records-vectors", [&](auto value) { return set_number(options.model.record_vectors, value, 1, kMany); }},
  };
}

}  // namespace

const char* transfer_usage() {
  return "usage: transfer --model FILE [--program GHOSTSPACE] [--archive STREAM.qnv] [--tables "
         "bytes,matrix,loss,archive]\n"
         "                [--rates MBIT/S,...] [--rtts MS,...] [--losses PERCENT,...] [--formats NAME,...]\n"
         "                [--limit SECONDS] [--parallel N] [--runs N] [--seed N] [--tcp cubic|bbr]\n"
         "                [--congestion NAME] [--orbit AZIMUTH,ELEVATION] [--tolerance OF-DIAGONAL] [--draco-bits N] "
         "[--packed-bytes N]\n"
         "                [--records-vectors N]\n"
         "formats: records packed vrml gzip draco cells-records cells-packed; cells: both of the last\n";
}

std::variant<TransferOptions, std::string> transfer_options(int count, char** arguments) {
  TransferOptions options;
  for (const Format& format : kFormats) options.formats.push_back(&format);
  std::error_code error;
  const auto self = std::filesystem::read_symlink("/proc/self/exe", error);
  options.program = (self.parent_path().parent_path() / "ghostspace").string();
  const std::vector<Option> known = table(options);
  bool congestion_given = false;
  for (int i = 1; i < count; ++i) {
    const std::string name = arguments[i];
    const auto found =
        std::find_if(known.begin(), known.end(), [&](const Option& option) { return option.name == name; });
    if (found == known.end()) return "there is no option " + name;
    if (i + 1 >= count) return name + " needs a value";
    if (const auto problem = found->set(arguments[++i])) return name + " " + arguments[i] + ": " + *problem;
    congestion_given = congestion_given || name == "--congestion";
  }
  if (options.model.file.empty()) return "--model is missing";
  // The default is the response for links with random loss.
  if (!congestion_given && serve_has_option(options.program, "--congestion")) options.congestion = "delay-aware";
  return options;
}

}  // namespace gs::bench
