// KaTeX writes MathML, which browsers show with fonts of their own: nothing is fetched.
document.addEventListener("DOMContentLoaded", () => {
  for (const element of document.querySelectorAll(".arithmatex")) {
    const display = element.textContent.startsWith("\\[");
    katex.render(element.textContent.slice(2, -2), element, { output: "mathml", displayMode: display, throwOnError: false });
  }
});
