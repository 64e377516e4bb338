#include "app/formats/datasets/arrays/array_file.h"
#include "app/formats/datasets/module/hdf5_driver.h"
#include "app/formats/datasets/module/hdf5_file.h"
#include "app/formats/datasets/module/picture_decoders.h"
#include "app/formats/datasets/module/tiff_file.h"
#include "app/formats/datasets/module/unpack_chunk.h"

namespace gs::app {
namespace {

// Readers of the module. A new format is one row here, and one row in the table of volumes.
constexpr ArrayReader kModuleReaders[] = {
    {"HDF5", open_hdf5_arrays},
    {"TIFF", open_tiff_arrays},
};

// Decoders of pictures in DICOM files.
constexpr PictureDecoder kPictureDecoders[] = {
    {"JPEG", decode_jpeg},
    {"JPEG-LS", decode_jpeg_ls},
    {"JPEG 2000", decode_jpeg_2000},
};

}  // namespace
}  // namespace gs::app

extern "C" __attribute__((visibility("default"))) const gs::app::DatasetModule* ghostspace_dataset_module() {
  static const gs::app::DatasetModule module{gs::app::DatasetModule::kVersion, gs::app::kModuleReaders,
                                             gs::app::kPictureDecoders, gs::app::unpack_chunk};
  { const gs::app::Hdf5Scope initialised; }  // before the process confines itself
  return &module;
}
