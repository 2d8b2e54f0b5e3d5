#include <pybind11/stl.h>

#include <utility>

#include <febiodea/io/results/plot_file.h>
#include <febiodea/io/results/result_file.h>
#include <febiodea/python/bind.h>
#include <febiodea/python/errors.h>
#include <febiodea/python/plain.h>
#include <febiodea/python/work.h>
#include <febiodea/views/map/draw_map.h>
#include <febiodea/views/map/map_figure.h>

namespace dea::python {

namespace {

/// What a map is of, as Python says it.
struct AskedMap {
  std::string field, surface, states;
  bool smooth = false, unrolled = false;
};

/// A result as the file that it would be written to.
std::shared_ptr<ResultFile> file_of(const std::shared_ptr<Analysed>& a) {
  const JointModel& model = a->recognised->recognition.model;
  const std::string& path = model.files.front();
  return result_of<ResultFile>([a, path](Work&) {
    return std::make_shared<ResultFile>(
        ResultFile{path, "dea", make_plot_file(a->recognised->recognition.model, a->analysis)});
  });
}

std::shared_ptr<MapFigure> figure_of(const std::shared_ptr<ResultFile>& file, const AskedMap& asked) {
  return result_of<MapFigure>([file, asked](Work&) {
    MapOptions options;
    options.field = asked.field;
    if (!asked.surface.empty()) options.surfaces = {asked.surface};
    options.states = asked.states;
    options.states_option = python_wording()(NamedSetting{"states", "", asked.states});
    options.smooth = asked.smooth;
    options.unrolled = asked.unrolled;
    return std::make_shared<MapFigure>(make_map_figure({*file}, nullptr, options));
  });
}

py::bytes picture_of(const std::shared_ptr<ResultFile>& file, const std::string& format, double width, double dpi,
                     const AskedMap& asked) {
  const std::shared_ptr<MapFigure> figure = figure_of(file, asked);
  PictureOptions options;
  options.format = format == "svg" ? PictureFormat::Svg : format == "pdf" ? PictureFormat::Pdf : PictureFormat::Png;
  options.width = width;
  options.dpi = dpi;
  return *result_of<std::string>(
      [figure, options](Work&) { return std::make_shared<std::string>(picture(*figure, options)); });
}

py::dict panel_dict(const std::shared_ptr<MapFigure>& figure, const MapPanel& panel) {
  const MapSurface& surface = figure->surfaces[at(panel.surface)];
  py::array_t<double> points({static_cast<py::ssize_t>(surface.projection.points.size()), py::ssize_t{2}});
  auto to = points.mutable_unchecked<2>();
  for (py::ssize_t i = 0; i < points.shape(0); ++i)
    for (int k = 0; k < 2; ++k) to(i, k) = surface.projection.points[at(i)](k);
  py::dict all;
  all["title"] = text(panel.title + panel.when);
  all["points"] = points;
  all["triangles"] = look(surface.mesh.triangles, figure);
  all["facet"] = look(surface.mesh.facet, figure);
  all["layer"] = look(surface.projection.layer, figure);
  all["facets"] = look(panel.facets, figure);
  all["nodes"] = look(panel.points, figure);
  return all;
}

py::dict figure_dict(const std::shared_ptr<MapFigure>& figure) {
  py::dict all;
  py::list panels, colours;
  for (const MapPanel& panel : figure->panels) panels.append(panel_dict(figure, panel));
  for (const auto& c : colour_table(figure->map))
    colours.append(py::make_tuple(c[0] / 255.0, c[1] / 255.0, c[2] / 255.0));
  all["panels"] = panels;
  all["colours"] = colours;
  all["low"] = figure->low;
  all["high"] = figure->high;
  all["ticks"] = figure->ticks;
  all["smooth"] = figure->smooth;
  all["quantity"] = text(figure->quantity + (figure->unit.empty() ? "" : " [" + figure->unit + "]"));
  all["remarks"] = texts(figure->remarks);
  return all;
}

}  // namespace

void bind_map(py::module_& m) {
  m.def("plot_file_of", &file_of);
  m.def("picture", [](const std::shared_ptr<ResultFile>& file, const std::string& format, double width, double dpi,
                      const std::string& field, const std::string& surface, const std::string& states, bool smooth,
                      bool unrolled) {
    return picture_of(file, format, width, dpi, {field, surface, states, smooth, unrolled});
  });
  m.def("map_of", [](const std::shared_ptr<ResultFile>& file, const std::string& field, const std::string& surface,
                     const std::string& states, bool smooth, bool unrolled) {
    return figure_dict(figure_of(file, {field, surface, states, smooth, unrolled}));
  });
}

}  // namespace dea::python
