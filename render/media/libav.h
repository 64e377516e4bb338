#pragma once

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/avutil.h>
#include <libavutil/dict.h>
#include <libavutil/imgutils.h>
#include <libavutil/log.h>
#include <libavutil/pixdesc.h>
#include <libavutil/samplefmt.h>
#include <libswscale/swscale.h>
}

#include <cstddef>
#include <string>

/// List of the FFmpeg functions that the program calls, with their libraries.
#define GHOSTSPACE_LIBAV_FUNCTIONS(X)         \
  X(avutil, av_dict_free)                     \
  X(avutil, av_dict_set)                      \
  X(avutil, av_frame_alloc)                   \
  X(avutil, av_frame_free)                    \
  X(avutil, av_frame_get_buffer)              \
  X(avutil, av_frame_make_writable)           \
  X(avutil, av_frame_move_ref)                \
  X(avutil, av_frame_unref)                   \
  X(avutil, av_free)                          \
  X(avutil, av_log_set_level)                 \
  X(avutil, av_malloc)                        \
  X(avutil, av_max_alloc)                     \
  X(avutil, av_pix_fmt_desc_get)              \
  X(avutil, av_sample_fmt_is_planar)          \
  X(avutil, av_strerror)                      \
  X(avcodec, av_packet_alloc)                 \
  X(avcodec, av_packet_free)                  \
  X(avcodec, av_packet_rescale_ts)            \
  X(avcodec, av_packet_unref)                 \
  X(avcodec, avcodec_alloc_context3)          \
  X(avcodec, avcodec_find_decoder)            \
  X(avcodec, avcodec_find_encoder_by_name)    \
  X(avcodec, avcodec_flush_buffers)           \
  X(avcodec, avcodec_free_context)            \
  X(avcodec, avcodec_open2)                   \
  X(avcodec, avcodec_parameters_from_context) \
  X(avcodec, avcodec_parameters_to_context)   \
  X(avcodec, avcodec_receive_frame)           \
  X(avcodec, avcodec_receive_packet)          \
  X(avcodec, avcodec_send_frame)              \
  X(avcodec, avcodec_send_packet)             \
  X(avformat, av_find_input_format)           \
  X(avformat, av_interleaved_write_frame)     \
  X(avformat, av_read_frame)                  \
  X(avformat, av_seek_frame)                  \
  X(avformat, av_write_trailer)               \
  X(avformat, avformat_alloc_context)         \
  X(avformat, avformat_alloc_output_context2) \
  X(avformat, avformat_close_input)           \
  X(avformat, avformat_find_stream_info)      \
  X(avformat, avformat_free_context)          \
  X(avformat, avformat_new_stream)            \
  X(avformat, avformat_open_input)            \
  X(avformat, avformat_write_header)          \
  X(avformat, avio_alloc_context)             \
  X(avformat, avio_context_free)              \
  X(swscale, sws_freeContext)                 \
  X(swscale, sws_getCoefficients)             \
  X(swscale, sws_getContext)                  \
  X(swscale, sws_scale)                       \
  X(swscale, sws_setColorspaceDetails)

namespace gs::render {

/// Functions of FFmpeg, loaded for the first movie or sound. Loading takes longer than drawing most worlds.
struct Libav {
#define GHOSTSPACE_LIBAV_MEMBER(library, name) decltype(&::name) name = nullptr;
  GHOSTSPACE_LIBAV_FUNCTIONS(GHOSTSPACE_LIBAV_MEMBER)
#undef GHOSTSPACE_LIBAV_MEMBER
  std::string problem;  // reason why FFmpeg is unavailable; empty on success

  Libav();

 private:
  void* open(const char* name);
};

/// Returns the functions of FFmpeg, the same for all threads. Thread-safe.
[[nodiscard]] const Libav& libav();

}  // namespace gs::render
