#include "bench/gui/presenters/plot_text_object.h"

#include <algorithm>
#include <utility>

namespace todbench {

PlotTextObject::PlotTextObject(std::vector<Plot> plots, double page_width_px)
    : plots_(std::move(plots)), page_width_(page_width_px) {}

const Plot& PlotTextObject::plot_of(const QTextFormat& format) const {
  return plots_.at(static_cast<std::size_t>(format.property(index_property).toInt()));
}

QSizeF PlotTextObject::intrinsicSize(QTextDocument* /*document*/, int /*position*/, const QTextFormat& format) {
  const Plot& plot = plot_of(format);
  const double width = std::min(page_width_, plot.width * 0.7);
  return {width, width * plot.height / plot.width};
}

void PlotTextObject::drawObject(QPainter* painter, const QRectF& area, QTextDocument* /*document*/, int /*position*/,
                                const QTextFormat& format) {
  paint_plot(*painter, area, plot_of(format), light_plot_colours());
}

}  // namespace todbench
