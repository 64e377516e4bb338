#pragma once

#include <cstddef>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace gs::bench {

/// One diagram of a plot: decibels over bytes, one curve per codec. An empty curve is left out.
struct PlotPanel {
  std::string title;
  std::vector<std::map<std::size_t, double>> curves;  // decibels by bytes
};

/// Codec of all panels, with its colour in SVG.
struct PlotCodec {
  std::string name, color;
};

/// Writes panels in two columns as SVG, from 1 kB to 2 MB and `range` decibels.
void write_plot(const std::string& path, std::span<const PlotCodec> codecs, std::span<const PlotPanel> panels,
                std::pair<int, int> range);

}  // namespace gs::bench
