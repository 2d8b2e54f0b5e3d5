#include <pybind11/stl.h>

#include <array>
#include <optional>
#include <utility>

#include "io/files/output.h"
#include "io/results/plot_file.h"
#include "io/results/result_file.h"
#include "python/bind.h"
#include "python/errors.h"
#include "python/plain.h"
#include "python/work.h"
#include "views/map/draw_map.h"
#include "views/map/map_figure.h"
#include "views/map/map_scale.h"

namespace dea::python {

namespace {

using namespace py::literals;

using File = std::shared_ptr<ResultFile>;

/// A result as the file that it would be written to.
std::shared_ptr<ResultFile> file_of(const std::shared_ptr<Analysed>& a) {
  return result_of([a](Work&) {
    const JointModel& model = a->recognised->recognition.model;
    return std::make_shared<ResultFile>(ResultFile{model.files.front(), "dea", make_plot_file(model, a->analysis)});
  });
}

/// Of several files side by side, with one scale; `labels`: what they are called, one each, or none.
std::shared_ptr<MapFigure> figure_of(const std::vector<File>& files, const std::vector<std::string>& labels,
                                     const std::string& field, const std::string& surface, const std::string& states,
                                     bool smooth, bool unrolled) {
  MapOptions options;
  options.field = field;
  if (!surface.empty()) options.surfaces = {surface};
  options.states = states;
  options.states_option = python_wording()(NamedSetting{"states", "", states});
  options.smooth = smooth;
  options.unrolled = unrolled;
  return result_of([files, labels, options](Work&) {
    std::vector<ResultFile> shown;
    for (const File& file : files) shown.push_back(*file);
    for (std::size_t i = 0; i < labels.size(); ++i) shown[i].label = labels[i];
    return std::make_shared<MapFigure>(make_map_figure(shown, nullptr, options));
  });
}

/// `path` empty: it is not written.
py::bytes picture_of(const std::vector<File>& files, const std::vector<std::string>& labels, const std::string& path,
                     const std::string& format, double width, double dpi, const std::string& field,
                     const std::string& surface, const std::string& states, bool smooth, bool unrolled) {
  const std::shared_ptr<MapFigure> figure = figure_of(files, labels, field, surface, states, smooth, unrolled);
  PictureOptions look;
  look.format = format == "svg" ? PictureFormat::Svg : format == "pdf" ? PictureFormat::Pdf : PictureFormat::Png;
  look.width = width;
  look.dpi = dpi;
  return result_of([figure, path, look](Work&) {
    std::string drawn = picture(*figure, look);
    if (!path.empty()) write_text(path, drawn);
    return drawn;
  });
}

py::tuple colour_tuple(const Rgb& c) { return py::make_tuple(c.r, c.g, c.b); }

/// A line that is closed ends where it begins.
py::list lines_of(const std::vector<Polyline>& lines) {
  py::list all;
  for (const Polyline& line : lines) {
    std::vector<std::array<double, 2>> points;
    for (const Vector2d& x : line.points) points.push_back({x.x(), x.y()});
    if (line.closed && !points.empty()) points.push_back(points.front());
    all.append(kept(std::move(points)));
  }
  return all;
}

/// The layers of a panel, those behind first.
py::list layers_of(const std::shared_ptr<MapFigure>& figure, const MapPanel& panel) {
  const MapSurface& surface = figure->surfaces[at(panel.surface)];
  py::list all;
  for (int layer = 0; layer < surface.projection.layers; ++layer) {
    const PanelMasks masks = panel_masks(*figure, panel, layer);
    all.append(py::dict("rim"_a = lines_of(rim(surface.mesh, surface.projection, masks.all)), "all"_a = kept(masks.all),
                        "away"_a = kept(masks.away), "valued"_a = kept(masks.valued),
                        "interpolated"_a = kept(masks.interpolated)));
  }
  return all;
}

py::object place_of(const std::optional<Vector2d>& place) {
  return place ? py::object(py::make_tuple(place->x(), place->y())) : py::object(py::none());
}

py::dict panel_dict(const std::shared_ptr<MapFigure>& figure, const MapPanel& panel) {
  const MapSurface& surface = figure->surfaces[at(panel.surface)];
  std::vector<std::array<double, 2>> points;
  for (const Vector2d& x : surface.projection.points) points.push_back({x.x(), x.y()});
  return py::dict("title"_a = text(panel.title), "points"_a = kept(std::move(points)),
                  "triangles"_a = view_of(surface.mesh.triangles, figure),
                  "facet"_a = view_of(surface.mesh.facet, figure), "layers"_a = layers_of(figure, panel),
                  "facets"_a = view_of(panel.facets, figure), "nodes"_a = view_of(panel.points, figure),
                  "edge"_a = panel.edge, "peak"_a = place_of(panel.peak),
                  "center_of_pressure"_a = place_of(panel.center_of_pressure));
}

/// Lines of equal value: the value, and the colour that is seen on it.
py::list contours_of(const MapFigure& figure) {
  py::list all;
  for (const double level : figure.contours) {
    const bool white = white_line(colour(figure.map, (level - figure.low) / (figure.high - figure.low)));
    all.append(py::make_tuple(level, white ? "white" : "black"));
  }
  return all;
}

py::dict figure_dict(const std::shared_ptr<MapFigure>& figure) {
  py::list panels, colours;
  for (const MapPanel& panel : figure->panels) panels.append(panel_dict(figure, panel));
  for (int b = 0; b < kBands; ++b) colours.append(colour_tuple(band_colour(figure->map, b)));
  const Paper white = paper(false, figure->map);
  return py::dict("panels"_a = panels, "colours"_a = colours, "nothing"_a = colour_tuple(white.nothing),
                  "turned_away"_a = colour_tuple(white.turned_away), "line"_a = colour_tuple(white.line),
                  "contours"_a = contours_of(*figure), "empty"_a = figure->empty, "low"_a = figure->low,
                  "high"_a = figure->high, "ticks"_a = figure->ticks, "smooth"_a = figure->smooth,
                  "quantity"_a = text(figure->quantity + (figure->unit.empty() ? "" : " [" + figure->unit + "]")));
}

}  // namespace

void bind_map(py::module_& m) {
  m.def("plot_file_of", &file_of);
  m.def("picture", &picture_of);
  m.def("map_of", [](const File& file, const std::string& field, const std::string& surface, const std::string& states,
                     bool smooth, bool unrolled) {
    return figure_dict(figure_of({file}, {}, field, surface, states, smooth, unrolled));
  });
}

}  // namespace dea::python
