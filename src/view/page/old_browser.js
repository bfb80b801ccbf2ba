// Browsers without modules get words instead of an empty page.
document.addEventListener("DOMContentLoaded", function () {
  document.body.textContent = "This browser is too old for vdbview: it needs JavaScript modules and web sockets.";
});
