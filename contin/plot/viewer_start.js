document.title = document.getElementById("title").textContent = data.title;
svg.setAttribute("aria-label", data.title);
legend();
regionKey();
show(view);
new ResizeObserver(draw).observe(svg);
