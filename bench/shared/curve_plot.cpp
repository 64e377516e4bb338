#include "bench/shared/curve_plot.h"

#include <algorithm>
#include <cmath>
#include <fstream>

namespace gs::bench {

void write_plot(const std::string& path, std::span<const PlotCodec> codecs, std::span<const PlotPanel> panels,
                std::pair<int, int> range) {
  constexpr int kWidth = 420, kHeight = 300, kColumns = 2;
  const auto [least, most] = range;
  const int rows = (static_cast<int>(panels.size()) + kColumns - 1) / kColumns;
  std::ofstream out(path);
  out << "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" << kWidth * kColumns << "\" height=\"" << kHeight * rows
      << "\" font-family=\"sans-serif\" font-size=\"11\">\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n";
  for (std::size_t i = 0; i < panels.size(); ++i) {
    const PlotPanel& panel = panels[i];
    const int left = static_cast<int>(i) % kColumns * kWidth + 45, top = static_cast<int>(i) / kColumns * kHeight + 25;
    const auto x = [&](double bytes) { return left + (std::log10(bytes) - 3) / 3.3 * (kWidth - 65); };
    const auto y = [&, least = least, most = most](double decibel) {
      return top + (1 - (decibel - least) / (most - least)) * (kHeight - 60);
    };
    out << "<text x=\"" << left << "\" y=\"" << top - 8 << "\" font-weight=\"bold\">" << panel.title << "</text>\n";
    for (int decibel = least; decibel <= most; decibel += 5)
      out << "<line x1=\"" << x(1e3) << "\" x2=\"" << x(2e6) << "\" y1=\"" << y(decibel) << "\" y2=\"" << y(decibel)
          << "\" stroke=\"#ddd\"/><text x=\"" << left - 5 << "\" y=\"" << y(decibel) + 4 << "\" text-anchor=\"end\">"
          << decibel << "</text>\n";
    for (const double bytes : {1e3, 1e4, 1e5, 1e6})
      out << "<text x=\"" << x(bytes) << "\" y=\"" << y(least) + 15 << "\" text-anchor=\"middle\">" << bytes / 1000
          << " kB</text>\n";
    int line = 0;
    for (std::size_t c = 0; c < std::min(codecs.size(), panel.curves.size()); ++c) {
      if (panel.curves[c].empty()) continue;
      out << "<polyline fill=\"none\" stroke-width=\"2\" stroke=\"" << codecs[c].color << "\" points=\"";
      for (const auto& [bytes, decibel] : panel.curves[c])
        out << x(static_cast<double>(bytes)) << ','
            << y(std::clamp(decibel, static_cast<double>(least), static_cast<double>(most))) << ' ';
      out << "\"/>\n<text x=\"" << x(1.3e3) << "\" y=\"" << top + 14 + 14 * line++ << "\" fill=\"" << codecs[c].color
          << "\">" << codecs[c].name << "</text>\n";
    }
  }
  out << "</svg>\n";
}

}  // namespace gs::bench
