#include "qnv/codecs/values/encode/step_coefficients.h"

#include "base/parallel.h"
#include "qnv/codecs/values/slices/band_buffer.h"

namespace gs::qnv::values {

StepCoefficients::StepCoefficients(Extent extent)
    : extent_(extent), layout_(extent, level_count(extent)), values_(sample_count(extent), 0) {}

void StepCoefficients::decode(const StoredBlocks& blocks, bool first, unsigned threads) {
  (void)parallel_for(
      layout_.count(),
      [&](std::size_t number) {
        thread_local BandBuffer decoded;
        const BlockPlace place = layout_.place(number);
        decoded.clear(place);
        const StoredCluster* const start = blocks.write(number, place, decoded.bands());
        if (first || (start && start->differs == 0))
          decoded.copy_to(place, bands_of(place));
        else if (start)
          decoded.add_to(place, bands_of(place));
      },
      threads);
}

SliceRestorer::WriteBlock StepCoefficients::writer() {
  return [this](std::uint64_t, const BlockPlace& place, const BlockBands& bands) {
    copy_bands(place, bands_of(place), bands);
  };
}

}  // namespace gs::qnv::values
