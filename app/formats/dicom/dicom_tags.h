#pragma once

#include <cstdint>

namespace gs::app {

/// Tag of a data element: group and element (PS3.5, 3.10). Only elements of this list are kept. All others, names and
/// birth dates of patients among them, are skipped where the file is read.
enum class DicomTag : std::uint32_t {
  transfer_syntax = 0x00020010,
  directory_records = 0x00041220,
  referenced_file = 0x00041500,
  image_type = 0x00080008,
  sop_class = 0x00080016,
  acquisition_time = 0x00080032,
  content_time = 0x00080033,
  modality = 0x00080060,
  frame_type = 0x00089007,
  slice_thickness = 0x00180050,
  echo_time = 0x00180081,
  echo_numbers = 0x00180086,
  spacing_between_slices = 0x00180088,
  trigger_time = 0x00181060,
  frame_time = 0x00181063,
  frame_time_vector = 0x00181065,
  imager_pixel_spacing = 0x00181164,
  ultrasound_regions = 0x00186011,
  physical_units_x = 0x00186024,
  physical_units_y = 0x00186026,
  physical_delta_x = 0x0018602c,
  physical_delta_y = 0x0018602e,
  effective_echo_time = 0x00189082,
  diffusion_b_value = 0x00189087,
  mr_echo = 0x00189114,
  mr_diffusion = 0x00189117,
  mr_frame_type = 0x00189226,
  ct_frame_type = 0x00189329,
  series_uid = 0x0020000e,
  series_number = 0x00200011,
  acquisition_number = 0x00200012,
  instance_number = 0x00200013,
  image_position = 0x00200032,
  image_orientation = 0x00200037,
  temporal_position = 0x00200100,
  frame_content = 0x00209111,
  plane_position = 0x00209113,
  plane_orientation = 0x00209116,
  temporal_position_index = 0x00209128,
  stack_id = 0x00209056,
  temporal_offset = 0x0020930d,
  temporal_positions = 0x00209310,
  samples = 0x00280002,
  photometric = 0x00280004,
  planar = 0x00280006,
  frames = 0x00280008,
  frame_increment = 0x00280009,
  rows = 0x00280010,
  columns = 0x00280011,
  pixel_spacing = 0x00280030,
  aspect_ratio = 0x00280034,
  bits_allocated = 0x00280100,
  bits_stored = 0x00280101,
  high_bit = 0x00280102,
  pixel_representation = 0x00280103,
  padding_value = 0x00280120,
  padding_limit = 0x00280121,
  window_center = 0x00281050,
  window_width = 0x00281051,
  rescale_intercept = 0x00281052,
  rescale_slope = 0x00281053,
  rescale_type = 0x00281054,
  red_descriptor = 0x00281101,
  green_descriptor = 0x00281102,
  blue_descriptor = 0x00281103,
  red_table = 0x00281201,
  green_table = 0x00281202,
  blue_table = 0x00281203,
  red_segments = 0x00281221,
  green_segments = 0x00281222,
  blue_segments = 0x00281223,
  pixel_measures = 0x00289110,
  frame_window = 0x00289132,
  pixel_transformation = 0x00289145,
  real_world_mapping = 0x00409096,
  real_world_intercept = 0x00409224,
  real_world_slope = 0x00409225,
  detector_information = 0x00540022,
  units = 0x00541001,
  frame_reference_time = 0x00541300,
  segmentation_type = 0x00620001,
  segment_identification = 0x0062000a,
  segment_number = 0x0062000b,
  fraction_maximum = 0x0062000e,
  dose_units = 0x30040002,
  frame_offsets = 0x3004000c,
  dose_scaling = 0x3004000e,
  shared_groups = 0x52009229,
  frame_groups = 0x52009230,
  extended_offsets = 0x7fe00001,
  extended_lengths = 0x7fe00002,
  float_pixels = 0x7fe00008,
  double_pixels = 0x7fe00009,
  pixels = 0x7fe00010,
  item = 0xfffee000,
  item_end = 0xfffee00d,
  sequence_end = 0xfffee0dd,
};

/// Form of a value, reduced from the value representations of PS3.5, 6.2.
enum class DicomForm : std::uint8_t { text, u16, u32, u64, f32, f64, sequence, bytes, unknown };

/// Returns the form of the values of a tag; unknown if the element is not kept.
[[nodiscard]] constexpr DicomForm form_of(DicomTag tag) {
  using enum DicomTag;
  switch (tag) {
    case directory_records:
    case ultrasound_regions:
    case mr_echo:
    case mr_diffusion:
    case mr_frame_type:
    case ct_frame_type:
    case frame_content:
    case plane_position:
    case plane_orientation:
    case temporal_positions:
    case pixel_measures:
    case frame_window:
    case pixel_transformation:
    case real_world_mapping:
    case detector_information:
    case segment_identification:
    case shared_groups:
    case frame_groups:
      return DicomForm::sequence;
    case transfer_syntax:
    case referenced_file:
    case image_type:
    case sop_class:
    case acquisition_time:
    case content_time:
    case modality:
    case frame_type:
    case slice_thickness:
    case echo_time:
    case echo_numbers:
    case spacing_between_slices:
    case trigger_time:
    case frame_time:
    case frame_time_vector:
    case imager_pixel_spacing:
    case series_uid:
    case series_number:
    case acquisition_number:
    case instance_number:
    case image_position:
    case image_orientation:
    case temporal_position:
    case stack_id:
    case photometric:
    case frames:
    case pixel_spacing:
    case aspect_ratio:
    case window_center:
    case window_width:
    case rescale_intercept:
    case rescale_slope:
    case rescale_type:
    case units:
    case frame_reference_time:
    case segmentation_type:
    case dose_units:
    case frame_offsets:
    case dose_scaling:
      return DicomForm::text;
    case physical_units_x:
    case physical_units_y:
    case samples:
    case planar:
    case rows:
    case columns:
    case bits_allocated:
    case bits_stored:
    case high_bit:
    case pixel_representation:
    case padding_value:
    case padding_limit:
    case red_descriptor:
    case green_descriptor:
    case blue_descriptor:
    case red_table:
    case green_table:
    case blue_table:
    case red_segments:
    case green_segments:
    case blue_segments:
    case segment_number:
    case fraction_maximum:
    case frame_increment:
      return DicomForm::u16;
    case temporal_position_index:
      return DicomForm::u32;
    case extended_offsets:
    case extended_lengths:
      return DicomForm::u64;
    case physical_delta_x:
    case physical_delta_y:
    case effective_echo_time:
    case diffusion_b_value:
    case temporal_offset:
    case real_world_intercept:
    case real_world_slope:
      return DicomForm::f64;
    case float_pixels:
    case double_pixels:
    case pixels:
      return DicomForm::bytes;
    case item:
    case item_end:
    case sequence_end:
      break;
  }
  return DicomForm::unknown;
}

}  // namespace gs::app
