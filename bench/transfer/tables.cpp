#include "bench/transfer/tables.h"

#include "bench/transfer/jobs.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <string>

namespace gs::bench {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

/// Times in seconds. kNever means that all data did not suffice. A time over the limit means that the data was not
/// received in time.
struct Times {
  double first = kNever, usable = kNever, end = kNever;
};

double limit_for(const TransferOptions& options, double megabits) {
  if (options.limit > 0) return options.limit;
  return megabits < 5 ? 60 : megabits < 50 ? 30 : 15;
}

TransferSpec spec_for(const TransferOptions& options, const Model& model, const Format& format, const LinkSpec& link) {
  TransferSpec spec;
  spec.link = link;
  spec.congestion_control = options.tcp;
  spec.file = format.file;
  spec.size = model.size(format);
  spec.cells = format.cells;
  spec.one_range = format.one_range;
  spec.limit = limit_for(options, link.bits_per_second / 1e6);
  return spec;
}

LinkSpec link_of(double megabits, double milliseconds, double percent, std::uint64_t seed) {
  LinkSpec link;
  link.bits_per_second = megabits * 1e6;
  link.round_trip = milliseconds / 1e3;
  link.loss = percent / 100;
  link.seed = seed;
  return link;
}

// Returns the picture of a recording of cells after this number of pieces.
Shown shown_after(Model& model, const Recording& recording, std::uint64_t pieces) {
  return model.show(list_of(std::span(recording.cells).first(static_cast<std::size_t>(pieces))));
}

Times times_of_cells(Model& model, const Recording& recording, double limit) {
  const double late = recording.complete ? kNever : limit + 1;
  Times times{late, late, recording.complete ? recording.last() : limit + 1};
  const std::uint64_t all = recording.cells.size();
  if (all == 0) return times;
  const Shown end = shown_after(model, recording, all);
  const auto at = [&](std::uint64_t pieces) { return recording.cells[static_cast<std::size_t>(pieces) - 1].seconds; };
  if (!end.anything) return times;
  const std::uint64_t first =
      least(1, all, 1, [&](std::uint64_t pieces) { return shown_after(model, recording, pieces).anything; });
  times.first = at(first);
  if (end.error.ssim >= kUsable)
    times.usable = at(least(first, all, 1, [&](std::uint64_t pieces) {
      return shown_after(model, recording, pieces).error.ssim >= kUsable;
    }));
  return times;
}

Times times_of_http(const Thresholds& thresholds, const Recording& recording, double limit) {
  const auto time = [&](const std::optional<std::uint64_t>& bytes) {
    return bytes ? recording.when(*bytes).value_or(limit + 1) : kNever;
  };
  return {time(thresholds.first), time(thresholds.usable), recording.complete ? recording.last() : limit + 1};
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values.empty() ? kNever : values[(values.size() - 1) / 2];
}

std::string seconds_text(double seconds, double limit) {
  char text[32];
  if (std::isinf(seconds)) return "never";
  if (seconds > limit)
    std::snprintf(text, sizeof text, "> %g", limit);
  else
    std::snprintf(text, sizeof text, seconds < 9.995 ? "%.2f" : "%.1f", seconds);
  return text;
}

std::string cell_text(const std::vector<Times>& runs, double limit) {
  std::vector<double> first, usable, end;
  for (const Times& times : runs) {
    first.push_back(times.first);
    usable.push_back(times.usable);
    end.push_back(times.end);
  }
  if (runs.empty()) return "-";
  return seconds_text(median(first), limit) + " / " + seconds_text(median(usable), limit) + " / " +
         seconds_text(median(end), limit);
}

/// Accuracy of the emulation, combined over all links.
struct Accuracy {
  double worst = 0;
  std::uint64_t late = 0, delivered = 0, not_carried = 0;

  void add(const LinkCounts& counts) {
    worst = std::max(worst, counts.worst_delay);
    late += counts.late;
    delivered += counts.to_client.delivered + counts.to_server.delivered;
    not_carried += counts.not_carried;
  }
  void print() const {
    std::printf(
        "The links delivered %llu packets; %.3f %% of them more than 1 ms after their time, the worst %.1f ms; the "
        "system refused %llu.\n\n",
        static_cast<unsigned long long>(delivered),
        delivered == 0 ? 0.0 : 100 * static_cast<double>(late) / static_cast<double>(delivered), worst * 1e3,
        static_cast<unsigned long long>(not_carried));
  }
};

void print_header(const char* corner, const std::vector<double>& losses) {
  std::printf("| %s |", corner);
  for (const double loss : losses) std::printf(" %g %% |", loss);
  std::printf("\n|---|");
  for (std::size_t i = 0; i < losses.size(); ++i) std::printf("--:|");
  std::printf("\n");
}

struct Place {
  double rate, round_trip, loss;
  const Format* format;
};

}  // namespace

void print_settings(const TransferOptions& options, const Model& model) {
  std::printf("%s, %zu triangles, seen from orbit %g,%g at %dx%d. ",
              std::filesystem::path(options.model.file).filename().string().c_str(), model.triangles(),
              static_cast<double>(options.model.view.azimuth), static_cast<double>(options.model.view.elevation),
              Studio::kWidth, Studio::kHeight);
  std::printf("Records: %zu vectors; packed: %zu. Draco: level 10, %d bits. ", model.record_vectors(),
              model.packed_vectors(), options.model.draco_bits);
  std::printf("TCP: %s; congestion response of cells: %s. ", options.tcp.c_str(),
              options.congestion.empty() ? "that of the server without --congestion" : options.congestion.c_str());
  std::printf("Clients of cells ask for 95 %% of the line. ");
  std::printf("Loss is each direction's, of data and of acknowledgements. %u run%s a field%s.\n\n", options.runs,
              options.runs == 1 ? "" : "s", options.runs == 1 ? "" : ", the median");
}

AllThresholds print_sizes(const TransferOptions& options, Model& model) {
  AllThresholds all;
  std::printf("| format | bytes | to the first picture | to SSIM %g | whole: SSIM | PSNR, dB |\n", kUsable);
  std::printf("|---|--:|--:|--:|--:|--:|\n");
  for (const Format* format : options.formats) {
    if (model.size(*format) == 0) {
      std::fprintf(stderr, "transfer: %s is left out: its programs are not there\n", std::string(format->name).c_str());
      continue;
    }
    const Thresholds thresholds = model.thresholds(*format);
    all[format] = thresholds;
    if (format->cells) continue;
    const auto text = [](const std::optional<std::uint64_t>& bytes) {
      return bytes ? std::to_string(*bytes) : "never";
    };
    std::printf("| %s | %llu | %s | %s | %.3f | %.1f |\n", std::string(format->title).c_str(),
                static_cast<unsigned long long>(thresholds.size), text(thresholds.first).c_str(),
                text(thresholds.usable).c_str(), thresholds.end.ssim, thresholds.end.psnr);
  }
  std::printf("\n");
  std::fflush(stdout);
  return all;
}

namespace {

std::vector<Place> places(const TransferOptions& options, const AllThresholds& thresholds) {
  std::vector<Place> all;
  for (const double rate : options.rates)
    for (const double round_trip : options.round_trips)
      for (const Format* format : options.formats)
        for (const double loss : options.losses)
          if (thresholds.contains(format)) all.push_back({rate, round_trip, loss, format});
  return all;
}

// Prints one table, with the fields of `results` from `at` on.
void print_table(const TransferOptions& options, const AllThresholds& thresholds, double rate, double round_trip,
                 const std::vector<std::vector<Times>>& results, std::size_t& at) {
  const double limit = limit_for(options, rate);
  std::printf("#### %g Mbit/s, %g ms\n\n", rate, round_trip);
  print_header("first picture / SSIM 0.9 / end, s; loss", options.losses);
  for (const Format* format : options.formats) {
    if (!thresholds.contains(format)) continue;
    std::printf("| %s |", std::string(format->title).c_str());
    for (std::size_t i = 0; i < options.losses.size(); ++i)
      std::printf(" %s |", cell_text(results[at++], limit).c_str());
    std::printf("\n");
  }
  std::printf("\n");
}

// Prints how much earlier a usable picture is complete than the VRML97 file, without loss.
void print_parts(const TransferOptions& options, const AllThresholds& thresholds, const std::vector<Place>& all,
                 const std::vector<std::vector<Times>>& results) {
  const auto time_of = [&](const Format* format, double rate, double round_trip, double Times::*which) {
    std::vector<double> values;
    for (std::size_t i = 0; i < all.size(); ++i)
      if (all[i].format == format && all[i].rate == rate && all[i].round_trip == round_trip && all[i].loss == 0)
        for (const Times& times : results[i]) values.push_back(times.*which);
    return median(values);
  };
  const Format* const vrml = format_named("vrml");
  std::printf("#### Time to SSIM 0.9 over that of the whole VRML97 file by HTTP, without loss\n\n| |");
  for (const auto& [format, known] : thresholds) std::printf(" %s |", std::string(format->title).c_str());
  std::printf("\n|---|");
  for (std::size_t i = 0; i < thresholds.size(); ++i) std::printf("--:|");
  std::printf("\n");
  for (const double rate : options.rates)
    for (const double round_trip : options.round_trips) {
      const double limit = limit_for(options, rate), whole = time_of(vrml, rate, round_trip, &Times::end);
      std::printf("| %g Mbit/s, %g ms |", rate, round_trip);
      for (const auto& [format, known] : thresholds) {
        const double usable = time_of(format, rate, round_trip, &Times::usable);
        if (whole > limit || usable > limit)
          std::printf(" - |");
        else
          std::printf(" %.3f |", usable / whole);
      }
      std::printf("\n");
    }
  std::printf("\n");
}

}  // namespace

bool print_matrix(const TransferOptions& options, Model& model, const ServerSpec& server,
                  const AllThresholds& thresholds) {
  const std::vector<Place> all = places(options, thresholds);
  std::vector<TransferSpec> specs;
  for (const Place& place : all)
    for (unsigned run = 0; run < options.runs; ++run)
      specs.push_back(spec_for(options, model, *place.format,
                               link_of(place.rate, place.round_trip, place.loss, options.seed + run)));
  const std::vector<Recording> recordings = transfer_all(specs, server, options.parallel);
  std::vector<std::vector<Times>> results(all.size());
  Accuracy accuracy;
  bool good = true;
  for (std::size_t i = 0; i < specs.size(); ++i) {
    const Recording& recording = recordings[i];
    const Format& format = *all[i / options.runs].format;
    accuracy.add(recording.link);
    good = good && recording.problem.empty();
    if (!recording.problem.empty()) continue;
    results[i / options.runs].push_back(format.cells
                                            ? times_of_cells(model, recording, specs[i].limit)
                                            : times_of_http(thresholds.at(&format), recording, specs[i].limit));
  }
  std::size_t at = 0;
  for (const double rate : options.rates)
    for (const double round_trip : options.round_trips) print_table(options, thresholds, rate, round_trip, results, at);
  if (thresholds.contains(format_named("vrml")) &&
      std::find(options.losses.begin(), options.losses.end(), 0.0) != options.losses.end())
    print_parts(options, thresholds, all, results);
  accuracy.print();
  std::fflush(stdout);
  return good;
}

bool print_loss(const TransferOptions& options, Model& model, const ServerSpec& server) {
  const std::vector<double> losses{0, 10, 30};
  constexpr double kRate = 10, kRoundTrip = 20;
  constexpr unsigned kMinRuns = 3;
  const unsigned runs = std::max(kMinRuns, options.runs);
  std::vector<TransferSpec> specs;
  std::vector<const Format*> formats;
  for (const Format* format : options.formats)
    if (format->cells && model.size(*format) > 0) formats.push_back(format);
  for (const Format* format : formats)
    for (const double loss : losses)
      for (unsigned run = 0; run < runs; ++run)
        specs.push_back(spec_for(options, model, *format, link_of(kRate, kRoundTrip, loss, options.seed + run)));
  const std::vector<Recording> recordings = transfer_all(specs, server, options.parallel);
  std::printf(
      "#### What losses cost the last picture: PSNR in dB (worst of %u runs; difference to 0 %%), nothing sent again, "
      "%g Mbit/s, %g ms\n\n",
      runs, kRate, kRoundTrip);
  print_header("loss", losses);
  bool good = true;
  std::size_t at = 0;
  for (const Format* format : formats) {
    std::printf("| %s |", std::string(format->title).c_str());
    double without = 0;
    for (std::size_t i = 0; i < losses.size(); ++i) {
      double worst = kNever;
      bool complete = true;
      for (unsigned run = 0; run < runs; ++run, ++at) {
        const Recording& recording = recordings[at];
        good = good && recording.problem.empty();
        complete = complete && recording.complete;
        worst = std::min(worst, shown_after(model, recording, recording.cells.size()).error.psnr);
      }
      if (i == 0) without = worst;
      std::printf(" %.1f (%+.1f)%s |", worst, worst - without, complete ? "" : ", not all was sent in time");
    }
    std::printf("\n");
  }
  std::printf("\n");
  std::fflush(stdout);
  return good;
}

}  // namespace gs::bench
